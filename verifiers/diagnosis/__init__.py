"""Causes and corrections that failing rows cite."""

"""Support: every body is held up by contact, joint or driver."""

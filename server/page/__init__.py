"""The web page of a workspace: what a person sees who watches an agent at work."""

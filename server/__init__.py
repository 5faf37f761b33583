"""Floor 7: the MCP server and the command line. Importing it loads nothing."""

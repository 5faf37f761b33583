"""Skills: instructions and data for the calling model, served as `skill://` resources. No code lives here."""

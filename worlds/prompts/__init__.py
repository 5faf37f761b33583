"""The text of prompts: units, marks, odd characters, numbers, languages. It knows nothing of specifications."""

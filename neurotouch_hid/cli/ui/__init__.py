"""Output, options, prompts and completion of all commands."""

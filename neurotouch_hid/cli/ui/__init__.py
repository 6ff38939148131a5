"""How commands speak and ask: output, options, prompts, completion."""

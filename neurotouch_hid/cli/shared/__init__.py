"""Parts of several commands: playing a driver, its page, commands without click."""

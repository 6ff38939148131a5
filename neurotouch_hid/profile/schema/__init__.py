"""The file formats as models: what a profile and a person's settings may say."""

"""What is wrong or risky in a profile, and how to say it."""

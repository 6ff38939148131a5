"""Start-up and interpreter tricks; each module says what breaks without it."""

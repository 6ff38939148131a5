"""The local web page: the driver publishes its newest state, and another process shows it.

driver: pipeline ─▶ publisher ── Unix socket ──▶ page: subscriber ─▶ hub ─▶ browsers
"""

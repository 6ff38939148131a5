"""The local web page: the line hands out its newest state, another process shows it.

line's process: observer ─▶ feed ── Unix socket ──▶ view's process: listener ─▶ hub ─▶ browsers
"""

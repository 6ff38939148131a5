"""Runs coroutines; in a thread, since the browser of other tests has a loop in this one."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import pytest


@pytest.fixture
def run_async():
    with ThreadPoolExecutor(1) as threads:
        yield lambda work: threads.submit(asyncio.run, work).result()

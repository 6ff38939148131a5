"""Connections to the page's server, as a browser makes them."""

import http.client
import json

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from tests.processes import LIMIT_S


def get(view, path="/", host=None, method="GET"):
    line = http.client.HTTPConnection("127.0.0.1", view.port, timeout=60)
    line.request(method, path, headers={"Host": host or f"127.0.0.1:{view.port}"})
    answer = line.getresponse()
    content = answer.read()
    line.close()
    return answer.status, dict(answer.getheaders()), content


def enter(view, **options):
    """A connection to the stream that has not shown a token."""
    origin = f"http://127.0.0.1:{view.port}"
    return connect(f"ws://127.0.0.1:{view.port}/stream", **{"origin": origin, **options})


def show_token(line, token, **more):
    line.send(json.dumps({"token": token, "hz": 0, **more}))
    return json.loads(line.recv(LIMIT_S))


def read_to_the_end(line) -> int:
    """The code with which the server closes."""
    try:
        while True:
            line.recv(LIMIT_S)
    except ConnectionClosed as closed:
        return closed.rcvd.code

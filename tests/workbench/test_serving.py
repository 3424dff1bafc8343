import socket
from types import SimpleNamespace
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
import viser
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from grasp_core.errors import GraspError
from workbench.serving import Guard, is_loopback, serve


def get(url: str, **headers: str) -> SimpleNamespace:
    try:
        with urlopen(Request(url, headers=headers), timeout=5) as answer:
            return SimpleNamespace(status_code=answer.status, headers=answer.headers)
    except HTTPError as error:
        return SimpleNamespace(status_code=error.code, headers=error.headers)


PROTOCOL = f"viser-v{viser.__version__}"


@pytest.fixture(scope="module")
def server():
    running, url = serve(port=0)
    yield running, url
    running.stop()


def test_the_page_is_served_with_its_real_port(server):
    running, url = server
    assert url == f"http://127.0.0.1:{running.get_port()}"
    answer = get(url)
    assert answer.status_code == 200
    assert answer.headers["X-Frame-Options"] == "DENY"


def test_a_busy_port_moves_up(server):
    running, _ = server
    other, url = serve(port=running.get_port())
    try:
        assert other.get_port() != running.get_port()
        assert url.endswith(str(other.get_port()))
    finally:
        other.stop()


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example:{port}", "127.0.0.1:1", "", "localhost@evil:{port}"]
)
def test_foreign_host_names_are_refused(server, host):
    running, url = server
    answer = get(url, Host=host.format(port=running.get_port()))
    assert answer.status_code == 403


def test_the_own_page_may_open_a_websocket(server):
    _running, url = server
    with connect(url.replace("http", "ws"), origin=url, subprotocols=[PROTOCOL], compression=None) as socket_:
        assert len(socket_.recv(timeout=5)) > 0


@pytest.mark.parametrize("origin", ["http://evil.example", "https://127.0.0.1:1", "null", "file://", None])
def test_foreign_origins_are_refused(server, origin):
    _running, url = server
    with pytest.raises(InvalidStatus) as refused:
        connect(url.replace("http", "ws"), origin=origin, subprotocols=[PROTOCOL], compression=None)
    assert refused.value.response.status_code == 403


def test_a_rebound_name_is_refused_even_when_host_and_origin_agree(server):
    running, url = server
    host = f"evil.example:{running.get_port()}"
    with pytest.raises(InvalidStatus) as refused:
        connect(
            url.replace("http", "ws"),
            origin=f"http://{host}",
            subprotocols=[PROTOCOL],
            additional_headers={"Host": host},
        )
    assert refused.value.response.status_code == 403


def test_nobody_can_ask_for_a_share_url(server):
    running, _ = server
    handled = {message.__name__ for message in running._websock_server._incoming_handlers}
    assert not {name for name in handled if "Share" in name}


def headers(**values: str) -> Headers:
    return Headers({name.replace("_", "-"): value for name, value in values.items()})


def test_other_addresses_need_the_token():
    guard = Guard("192.168.1.5", "secret")
    own = headers(Host="192.168.1.5:8080")
    assert guard.refusal(own, "/", 8080)[0] == 401
    assert guard.refusal(own, "/?token=wrong", 8080)[0] == 401
    assert guard.refusal(own, "/?token=secret", 8080) is None
    cookie = guard.cookie()
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    assert guard.refusal(headers(Host="192.168.1.5:8080", Cookie=cookie.split(";")[0]), "/", 8080) is None
    assert guard.refusal(headers(Host="evil.example:8080"), "/?token=secret", 8080)[0] == 403
    assert Guard("127.0.0.1", None).cookie() is None


def test_a_token_is_made_for_other_addresses_only():
    running, url = serve("0.0.0.0", 0)
    try:
        assert "/?token=" in url
        local = f"http://127.0.0.1:{running.get_port()}/"
        assert get(local).status_code == 401
        opened = get(local + "?token=" + url.split("token=")[1])
        assert opened.status_code == 200
        assert "HttpOnly" in opened.headers["Set-Cookie"]
    finally:
        running.stop()


def test_two_values_of_a_header_are_refused():
    doubled = Headers([("Host", "127.0.0.1:8080"), ("Host", "evil.example")])
    assert Guard("127.0.0.1", None).refusal(doubled, "/", 8080)[0] == 403


@pytest.mark.parametrize("host, near", [("127.0.0.1", True), ("localhost", True), ("[::1]", True), ("0.0.0.0", False)])
def test_loopback(host, near):
    assert is_loopback(host) is near


def test_an_address_of_another_machine_is_refused_at_once():
    with pytest.raises(GraspError, match=r"--host 203\.0\.113\.7"):
        serve("203.0.113.7", 0)
    with pytest.raises(GraspError, match="65535"):
        serve(port=70000)


def test_sockets_are_bound_to_the_loopback_address(server):
    running, _ = server
    own = socket.gethostbyname(socket.gethostname())
    if own.startswith("127."):
        pytest.skip("this machine has no address but the loopback one")
    with pytest.raises(OSError):
        socket.create_connection((own, running.get_port()), timeout=1).close()

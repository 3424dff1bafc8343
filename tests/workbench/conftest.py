"""A small planned scene that needs no network, and a viser client that only remembers what it was told."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.grasp import Grasp, to_image
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.planning.places import PlaceScores
from grasp_core.planning.planner import Candidate, Plan
from grasp_core.scene import Scene, place
from grasp_core.simulation.recording import Recording
from workbench.actions import Action, Effect, Tick
from workbench.inspector.orders import Catalogue, Choice, OpenedScene, Rest, SceneRequest, Sight, Thing, Try
from workbench.inspector.setup import DEFAULT
from workbench.inspector.state import State
from workbench.state import Shell

REQUEST = SceneRequest((Thing("box_003"),), 1)


def make_asset() -> ObjectAsset:
    box = trimesh.creation.box((0.12, 0.04, 0.06))
    part = Part(np.asarray(box.vertices, float), np.asarray(box.faces, np.int32))
    inertia = np.diag([0.06**2 + 0.04**2, 0.12**2 + 0.06**2, 0.12**2 + 0.04**2]) * box.volume / 12
    return ObjectAsset("box_003", "box_", part.vertices, part.faces, (part,), float(box.volume), inertia)


def make_plan(candidates: int = 3, reason: str | None = None, quality: bool = True, camera=None) -> Plan:
    camera = camera or canonical_camera()
    depth = np.full((300, 300), 0.7, np.float32)
    depth[120:160, 110:200] = 0.64
    found = []
    for index in range(candidates):
        grasp = Grasp((0.01 + 0.01 * index, 0.02, 0.03), 0.3 + np.pi / 2 - 0.2 * index, 0.08)
        found.append(Candidate(grasp, to_image(grasp, camera), 0.9 - 0.3 * index, 0.8 - 0.1 * index))
    heat = np.zeros((300, 300), np.float32)
    heat[130:150, 120:190] = 0.7 if quality else 0
    return Plan(
        candidates=tuple(found),
        canvas=DepthImage.from_array(depth, camera),
        quality_map=heat,
        region=(150.0, 140.0, 25.0),
        sampled=np.array([[150.0, 140], [155, 138]]),
        scored=tuple(found),
        stages_ms={"rectify": 2.0, "regression": 8.0, "refined": 30.0},
        reason=reason,
        camera=camera,
        weights="test",
        missing=0.0,
    )


def make_sight(plans=None) -> Sight:
    plans = plans or (make_plan(),)
    crops = tuple(None if plan is None else np.zeros((len(plan.candidates), 48, 48), np.float32) for plan in plans)
    failures = tuple("the weights are for another gripper" if plan is None else "" for plan in plans)
    image = make_plan().canvas
    return Sight(image, tuple(plans), failures, crops, 1.4, {"render": 11.0})


def make_opened(candidates: int = 3, reason: str | None = None, quality: bool = True, setup=DEFAULT) -> OpenedScene:
    rest = np.eye(4)
    rest[2, 3] = 0.03
    scene = Scene.single(make_asset(), place(rest, 0.01, 0.02, 0.3))
    plans = tuple(make_plan(candidates, reason, quality) for _ in setup.planners)
    rests = (Rest(((rest, 0.75), (rest, 0.25)), 0),)
    return OpenedScene(REQUEST, setup, scene, rests, load_gripper(), make_sight(plans))


def make_scores(u: float, v: float) -> PlaceScores:
    camera = canonical_camera()
    found = []
    for index, angle in enumerate(np.arange(12) * np.pi / 12 - np.pi / 2):
        grasp = Grasp((0.0, 0.0, 0.03), float(angle), 0.1)
        found.append(Candidate(grasp, to_image(grasp, camera), index / 12))
    return PlaceScores(u, v, 0.04, True, tuple(found), np.arange(12) % 3 > 0)


def make_try(number: int = 0, outcome: str = "SUCCESS", recorded: bool = True) -> Try:
    count = 21
    poses = np.zeros((count, 5, 7), np.float32)
    poses[:, :, 3] = 1
    poses[:, :, 2] = np.linspace(0, 0.2, count)[:, None]
    recording = Recording(
        names=("object_0", "base", "rod", "left_finger", "right_finger"),
        times=np.linspace(0, 2, count),
        phases=np.zeros(count, np.int8),
        poses=poses,
        fingers=np.zeros((count, 2), np.float32),
        contact_frames=np.array([10, 10, 11], np.int32),
        contact_points=np.zeros((3, 3), np.float32),
        contact_forces=np.ones((3, 3), np.float32),
        contact_fingers=np.array([0, 1, 0], np.int8),
        contact_objects=np.zeros(3, np.int16),
        outcome=outcome,
        words="held",
    )
    return Try(
        number=number,
        outcome=outcome,
        words="held to the end",
        seed=100 + number,
        executed=Grasp((0.01, 0.02, 0.03), 0.3, 0.08),
        moved=(0.004, 0.1),
        dynamic=True,
        redraws=0,
        evidence='{"words":"held to the end"}',
        recording=recording if recorded else None,
    )


class Handle:
    """Remembers properties and handlers of a widget or scene node."""

    def __init__(self, kind: str, **properties):
        self.kind = kind
        self.handlers = []
        self.visible = True
        self.label = None
        self._impl = SimpleNamespace(uuid="11111111-2222")
        self.__dict__.update(properties)

    def _add(self, handler):
        self.handlers.append(handler)
        return handler

    on_update = on_click = on_trigger = on_upload = _add

    def remove_click_callback(self, callback):
        assert callback == "all"
        self.handlers.clear()


class Client:
    """Stands for a browser: `gui` and `scene` make handles, all kept in `made`."""

    def __init__(self):
        self.made: list[Handle] = []
        self.notices = []
        self.gui = self.scene = self
        self.main_panel = SimpleNamespace(dock_left=lambda: None, set_width=lambda width: None)
        self.kept: dict[str, str] = {}
        self.local_storage = SimpleNamespace(set_item=self.kept.__setitem__)
        self.files = []
        self.themes = []
        self._websock_interface = SimpleNamespace(
            unregister_handler=lambda message: None, register_handler=lambda message, handler: None
        )

    def _make(self, kind, **properties):
        handle = Handle(kind, **properties)
        self.made.append(handle)
        return handle

    def __getattr__(self, name):
        if name.startswith(("configure_", "set_")):
            return lambda *args, **options: None
        if not name.startswith("add_"):
            raise AttributeError(name)
        return lambda label=None, *args, **options: self._make(
            name,
            **{
                "label": label,
                "args": args,
                "wxyz": (1.0, 0, 0, 0),
                "position": (0.0, 0, 0),
                "visible": True,
                "opacity": None,
                **options,
            },
        )

    def add_html(self, content):
        return self._make("html", content=content)

    def add_text(self, label, value, hint=None):
        return self._make("text", label=label, value=value)

    def add_upload_button(self, label, *, mime_type, hint, icon):
        return self._make("upload", label=label, mime_type=mime_type, value=None)

    def configure_theme(self, **options):
        self.themes.append(options)

    def send_file_download(self, name, content, save_immediately):
        self.files.append((name, content))

    def add_dropdown(self, label, options, *, initial_value, hint):
        return self._make("dropdown", label=label, options=options, value=initial_value, disabled=False)

    def add_slider(self, label, *, min, max, step, initial_value, hint):
        return self._make("slider", label=label, min=min, max=max, step=step, value=initial_value, disabled=False)

    def add_panel(self):
        return _Panel()

    def add_notification(self, title, body, **options):
        self.notices.append((title, body))

    def add_modal(self, title):
        return _Block()

    def atomic(self):
        return _Block()

    def only(self, kind, label=None):
        found = [handle for handle in self.made if handle.kind == kind and label in (None, handle.label)]
        assert len(found) == 1, (kind, label, len(found))
        return found[0]

    def page(self) -> str:
        """All HTML that is shown."""
        return "\n".join(handle.content for handle in self.made if handle.kind == "html")


class _Block:
    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None


class _Panel:
    visible = True

    def add_tab(self, label, icon):
        return _Block()

    def dock_right(self):
        pass

    def set_width(self, width):
        pass


@pytest.fixture
def opened() -> OpenedScene:
    return make_opened()


@pytest.fixture
def catalogue() -> Catalogue:
    return Catalogue(("box", "mug", "pen"), "~/data/own")


@pytest.fixture
def state(catalogue) -> State:
    return State(catalogue, REQUEST)


@pytest.fixture
def shown(state, opened):
    from dataclasses import replace

    return replace(state, ticket=1, scene=opened, scene_ticket=1, choice=Choice(0, 0))


@pytest.fixture
def client() -> Client:
    return Client()


@pytest.fixture
def posted() -> list[Action]:
    return []


@pytest.fixture
def bridge(client, posted):
    from workbench.bridge import Bridge
    from workbench.inspector.view import READERS

    return Bridge(client, posted.append, READERS)


@pytest.fixture
def attempt():
    return make_try


@pytest.fixture
def scores():
    return make_scores


@pytest.fixture
def make_scene():
    return make_opened


@pytest.fixture
def sight():
    return make_sight


@pytest.fixture
def one_plan():
    return make_plan


@pytest.fixture
def empty_scene() -> OpenedScene:
    return make_opened(0, reason="nothing stands on the table", quality=False)


@dataclass(frozen=True)
class Count(Action):
    """The one action of the view below."""

    by: int


@dataclass(frozen=True)
class Ring(Effect):
    """Its one effect."""

    loud: bool


class Counter:
    """The smallest view: it counts."""

    name, label, actions = "count", "Count", Count
    readers = {"count": lambda argument: Count(int(argument))}  # noqa: RUF012

    def __init__(self, name="count"):
        self.name = name
        self.rung = []
        self.readers = {} if name != "count" else self.readers

    def first(self, kept):
        return int(kept.get("value", 0))

    def arrive(self, state, query, shown):
        return (int(query["value"]), (Ring(shown),)) if "value" in query else (state, ())

    def reduce(self, state, action):
        return (state + 1, ()) if isinstance(action, Tick) else (state + action.by, (Ring(action.by > 5),))

    def ticking(self, state):
        return 0 < state < 5

    def moving(self, state):
        return state == 9

    def link(self, state):
        return {"value": str(state)}

    def keep(self, state):
        return {"value": state}

    def show(self, bridge, state):
        self.shown = []
        bridge.html(f"made {self.name}")
        return SimpleNamespace(update=lambda old, new: self.shown.append((old, new)))

    def perform(self, post, effect):
        if isinstance(effect, Ring):
            self.rung.append(effect)
            return True
        return False


@pytest.fixture
def counter():
    return Counter()


@pytest.fixture
def shell(counter):
    return Shell([counter, Counter("other")])


@pytest.fixture
def count():
    return Count


@pytest.fixture
def ring():
    return Ring

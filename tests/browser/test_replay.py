"""The replay in a real browser, against the very data that was recorded."""

import io
import re
from importlib.resources import files

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from harness.replay.document import document
from harness.replay.page import replay_page

pytestmark = pytest.mark.xdist_group("browser")

SMALL = {"width": 900, "height": 640}  # software draws what it shows
NO_WEBGL = """HTMLCanvasElement.prototype.getContext = ((real) => function (kind, ...rest) {
  return kind === "webgl2" ? null : real.call(this, kind, ...rest);
})(HTMLCanvasElement.prototype.getContext);"""
WALLS = ("x−", "x+", "y−", "y+", "z−", "z+")


@pytest.fixture(scope="session")
def pages(cubes, spheres, gaps, impacts, tmp_path_factory):
    folder = tmp_path_factory.mktemp("replay")
    recordings = {"cubes": cubes, "spheres": spheres, "gaps": gaps, "impacts": impacts}
    for name, recording in recordings.items():
        (folder / f"{name}.html").write_text(replay_page(recording, name.title()), encoding="utf-8")
    return folder


@pytest.fixture
def replay(visit, pages):
    """Opens one of the pages, drawn."""

    def show(name="cubes", **options):
        page = visit((pages / f"{name}.html").as_uri(), viewport=SMALL, **options).page
        page.wait_for_selector("html.drawn")
        return page

    return show


def names(recording):
    """Each hit as the page calls it."""
    return [
        f"{i} – {j if wall < 0 else f'wall {WALLS[wall]}'}"
        for (i, j), wall in zip(recording.hit_bodies.tolist(), recording.hit_walls.tolist(), strict=True)
    ]


def time_of(page):
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return float(re.search(r"t = ([\d.]+) s", page.locator("#now").text_content()).group(1))


def position(recording, body, time):
    leg = np.flatnonzero((recording.leg_bodies == body) & (recording.leg_times <= time))[-1]
    flown = recording.leg_velocities[leg] * (time - recording.leg_times[leg])
    return recording.leg_positions[leg] + flown, np.linalg.norm(recording.leg_velocities[leg])


@pytest.mark.slow
def test_every_hit_stands_in_the_list_with_its_time(replay, cubes):
    page = replay()
    found = {}
    for top in range(0, 30 * len(cubes.hit_times) + 200, 200):
        page.evaluate("(top) => { document.getElementById('hits').scrollTop = top; }", top)
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        rows = page.eval_on_selector_all(
            "#hits button",
            "(rows) => rows.map((row) => [row.dataset.hit, row.children[0].textContent, row.children[1].textContent])",
        )
        found |= {int(hit): (when, who) for hit, when, who in rows}
    assert len(cubes.hit_times) > 15
    expected = [(f"{time:.3f} s", name) for time, name in zip(cubes.hit_times, names(cubes), strict=True)]
    assert [found[hit] for hit in range(len(expected))] == expected


@pytest.mark.slow
def test_buttons_jump_from_hit_to_hit_and_name_the_bodies(replay, cubes):
    page = replay()
    times = np.unique(cubes.hit_times)
    for time in times[:4]:
        page.click("#after")
        assert abs(time_of(page) - time) < 1e-3
        now = [name for name, when in zip(names(cubes), cubes.hit_times, strict=True) if when == time]
        assert page.locator("#now").text_content().endswith("now " + ", ".join(now))
        assert page.locator("#hits [aria-current] span:last-child").all_text_contents() == now
        assert ", ".join(now) in page.locator("#said").text_content()
    page.click("#before")
    assert abs(time_of(page) - times[2]) < 1e-3
    page.click("#on")
    assert abs(time_of(page) - times[2] - cubes.dt) < 1e-3
    page.click("#back")
    page.click("#back")
    assert abs(time_of(page) - times[2] + cubes.dt) < 1e-3


@pytest.mark.slow
def test_a_row_of_the_list_jumps_to_its_hit(replay, spheres):
    page = replay("spheres")
    page.locator("#hits button").nth(5).click()
    assert abs(time_of(page) - spheres.hit_times[5]) < 1e-3
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    assert abs(time_of(page) - spheres.hit_times[6]) < 1e-3


@pytest.mark.slow
def test_keys_play_step_and_jump(replay, cubes):
    page = replay()
    page.focus("#stage")
    page.keyboard.press(".")
    page.keyboard.press(".")
    assert abs(time_of(page) - 2 * cubes.dt) < 1e-3
    page.keyboard.press("]")
    after = cubes.hit_times[cubes.hit_times > 2 * cubes.dt][0]
    assert abs(time_of(page) - after) < 1e-3
    page.keyboard.press("Space")
    page.wait_for_function("(from) => Number(document.getElementById('time').value) > from + 0.1", arg=after)
    page.keyboard.press("Space")
    paused = time_of(page)
    page.wait_for_timeout(150)
    assert time_of(page) == paused
    page.focus("#time")
    page.keyboard.press("End")
    assert abs(time_of(page) - cubes.duration) < 1e-3


@pytest.mark.slow
def test_a_chosen_body_tells_its_speed_and_hits(replay, cubes):
    page = replay()
    body = int(np.bincount(cubes.hit_bodies[:, 0]).argmax())
    mine = np.flatnonzero((cubes.hit_bodies == body).any(axis=1))
    page.fill("#body", str(body))
    page.keyboard.press("Enter")
    for _ in range(10):
        page.click("#after")
    time = np.unique(cubes.hit_times)[9]
    assert abs(time_of(page) - time) < 1e-3
    assert page.text_content("#body-speed") == f"{position(cubes, body, time)[1]:#.4g} m/s"
    so_far = int((cubes.hit_times[mine] <= time).sum())
    assert page.text_content("#body-hits") == f"{so_far} of {len(mine)}"
    following = mine[so_far]
    wait = cubes.hit_times[following] - time
    assert page.text_content("#body-next") == f"{names(cubes)[following]} in {wait:.3f} s"
    page.check("#only")
    assert page.locator("#hits li").first.get_attribute("aria-setsize") == str(len(mine))


@pytest.mark.slow
def test_a_click_on_a_body_chooses_it_and_the_camera_turns_by_drag_wheel_and_keys(replay):
    page = replay("spheres")
    frame = page.locator("#stage").bounding_box()
    for place in np.random.default_rng(1).uniform(0.3, 0.7, (60, 2)):
        page.mouse.click(frame["x"] + place[0] * frame["width"], frame["y"] + place[1] * frame["height"])
        if page.input_value("#body"):
            break
    assert page.input_value("#body")
    pictures = [page.locator("#stage").screenshot()]
    page.mouse.move(frame["x"] + 200, frame["y"] + 200)
    page.mouse.down()
    page.mouse.move(frame["x"] + 260, frame["y"] + 220, steps=3)
    page.mouse.up()
    pictures.append(page.locator("#stage").screenshot())
    page.mouse.wheel(0, -300)
    pictures.append(page.locator("#stage").screenshot())
    page.focus("#stage")
    page.keyboard.press("ArrowLeft")
    pictures.append(page.locator("#stage").screenshot())
    page.check("#halos")
    pictures.append(page.locator("#stage").screenshot())
    page.check("#ahead")
    pictures.append(page.locator("#stage").screenshot())
    assert len(set(pictures)) == len(pictures)


@pytest.mark.slow
def test_bodies_are_drawn_and_those_that_hit_are_marked(replay, cubes):
    page = replay()
    first = page.locator("#stage").screenshot()
    assert 0.01 < share(first, lambda r, g, b: (r > 1.5 * b) & (r > g)) < 0.6  # orange
    assert share(first, lambda r, g, b: (b > 1.6 * r) & (b > 90)) < 0.001
    pair = int(np.flatnonzero(cubes.hit_walls < 0)[0])
    page.eval_on_selector(
        "#time",
        "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }",
        cubes.hit_times[pair],
    )
    time_of(page)
    assert share(page.locator("#stage").screenshot(), lambda r, g, b: (b > 1.6 * r) & (b > 90)) > 0.002  # blue


def share(picture, test):
    red, green, blue = np.moveaxis(np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), float), -1, 0)
    return test(red, green, blue).mean()


@pytest.mark.slow
def test_it_plays_by_itself_only_where_motion_is_welcome(visit, pages):
    address = (pages / "spheres.html").as_uri()
    still, moving = visit(address).page, visit(address, reduced_motion="no-preference").page
    moving.wait_for_function("() => Number(document.getElementById('time').value) > 0.05")
    assert time_of(still) == 0


@pytest.mark.slow
def test_without_webgl_there_are_a_sentence_a_still_and_the_list(visit, pages, cubes):
    page = visit((pages / "cubes.html").as_uri(), script=NO_WEBGL).page
    assert page.get_by_text("This browser draws no WebGL2").is_visible()
    assert page.locator(".picture img").is_visible()
    page.click("#after")
    assert abs(time_of(page) - cubes.hit_times[0]) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cubes", "spheres"])
def test_the_viewer_puts_bodies_where_the_run_had_them(replay, name, request):
    recording = request.getfixturevalue(name)
    source = (files("harness.replay") / "viewer" / "recording.js").read_text(encoding="utf-8")
    times = [0.0, 0.37, *recording.hit_times[::7].tolist(), recording.duration]
    page = replay(name)
    found = page.evaluate(
        """([source, document, times]) => {
          const Recording = new Function(source.replace(/^export /gm, "") + "; return Recording")();
          const recording = new Recording(document), n = recording.count;
          return times.map((time) => {
            const places = new Float64Array(3 * n), turns = new Float64Array(4 * n);
            recording.posesAt(time, places, turns);
            return [[...places], [...turns]];
          });
        }""",
        [source, document(recording, name), times],
    )
    for time, (places, turns) in zip(times, found, strict=True):
        expected = np.array([position(recording, body, time)[0] for body in range(len(recording))])
        assert np.abs(np.reshape(places, (-1, 3)) - expected).max() < 1e-6
        if recording.surfaces:
            start = Rotation.from_quat(recording.quaternions, scalar_first=True)
            ours = Rotation.from_quat(np.reshape(turns, (-1, 4)), scalar_first=True)
            assert ((Rotation.from_rotvec(recording.spins * time) * start).inv() * ours).magnitude().max() < 1e-5


def _painted(page, name):
    """How many pixels of the picture have a colour of the page's style, about."""
    shown = np.asarray(Image.open(io.BytesIO(page.locator("#stage").screenshot())).convert("RGB"), np.int64)
    colour = page.evaluate("(name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()", name)
    wanted = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)])
    return int((np.abs(shown - wanted).max(axis=2) <= 24).sum())


@pytest.mark.slow
def test_a_line_joins_the_nearest_points_of_near_bodies(replay, gaps):
    page = replay("gaps")
    assert page.locator("#key-near").is_visible()
    assert not page.locator("#key-ring").is_visible()
    time_of(page)
    assert "0 pairs near but apart" in page.locator("#now").text_content()
    without = _painted(page, "--near")
    page.click("#on")
    time_of(page)
    first = gaps.near.frames == 1
    lengths = np.linalg.norm(gaps.near.points[first, 0] - gaps.near.points[first, 1], axis=1)
    i, j = gaps.near.pairs[first][lengths.argmin()]
    text = page.locator("#now").text_content()
    assert f"{first.sum()} pairs near but apart" in text
    found = re.search(r"the shortest line (\d+) – (\d+): ([\d.]+) m", text)
    assert (int(found[1]), int(found[2])) == (i, j)
    assert abs(float(found[3]) - lengths.min()) < 0.005 * lengths.min()
    assert "events" in text
    assert "hits" not in text
    assert _painted(page, "--near") > without + 20


@pytest.mark.slow
def test_a_ring_shows_where_bodies_met_in_the_frame_of_the_hit(replay, impacts):
    page = replay("impacts")
    assert page.locator("#key-ring").is_visible()
    assert not page.locator("#key-near").is_visible()
    time_of(page)
    without = _painted(page, "--ink")
    time = impacts.hit_times[impacts.hit_walls < 0][0]
    while time_of(page) < time - 5e-4:
        page.click("#after")
    assert abs(time_of(page) - time) < 1e-3
    assert _painted(page, "--ink") > without + 20
    page.click("#back")
    page.click("#back")
    time_of(page)
    assert _painted(page, "--ink") <= without + 20

"""Kernels are compiled ahead of a sweep, once, and nothing that goes wrong there harms the sweep."""

import os

import pytest

from harness.runner import compilation
from harness.runner.compilation import compile_ahead


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """What is compiled ahead, told by files: each named as its warm-up is."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(compilation, "usable_cores", lambda: 2)
    made = tmp_path / "made"
    made.mkdir()

    def warm_ups(point):
        yield "placement", (made / "placement").touch
        yield f"frames of {point.scene.shape}s", (made / point.scene.shape).touch
        yield "missing", lambda: 1 / 0
        yield "deadly", lambda: os._exit(1) if (made / "die").exists() else None

    monkeypatch.setattr(compilation, "warm_ups", warm_ups)

    def taken():
        names = sorted(file.name for file in made.iterdir())
        for file in made.iterdir():
            file.unlink()
        return names

    taken.folder = made
    return taken


def test_what_was_compiled_is_not_compiled_again_and_what_fails_is_left_to_the_server(spheres, compiled):
    points = spheres().points
    compile_ahead(points)
    assert compiled() == ["placement", "sphere"]
    compile_ahead(points)
    assert compiled() == []


def test_other_sources_are_compiled_anew(spheres, compiled, monkeypatch):
    compile_ahead(spheres().points)
    compiled()
    monkeypatch.setattr(compilation, "sources_hash", lambda: "others")
    compile_ahead(spheres().points)
    assert compiled() == ["placement", "sphere"]


def test_a_process_that_ends_ends_nothing_else(spheres, compiled):
    (compiled.folder / "die").touch()
    compile_ahead(spheres().points)


def test_with_one_core_there_is_nothing_to_share_out(spheres, compiled, monkeypatch):
    monkeypatch.setattr(compilation, "usable_cores", lambda: 1)
    compile_ahead(spheres().points)
    assert compiled() == []


def test_points_of_a_plugin_are_passed_over(spheres, compiled, plugin):
    plugin("stranger")
    compile_ahead(spheres(backend="stranger", algorithm="native").points)
    assert compiled() == []

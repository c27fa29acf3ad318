"""A kernel is compiled anew where its file is missing, cut short, or cannot be kept."""

import runpy
import shutil
import subprocess
import sys

import numba
import pytest

from harness.kernel_cache import PACKAGE, _Turn, all_sources, forgiving, user_cache

KERNEL = """
from harness.kernel import kernel

@kernel
def twice(x):
    return 2 * x
"""
PROGRAM = f"""
import sys
import numba
numba.config.CACHE_DIR = sys.argv[1]
{KERNEL}
print(twice(21), sum(twice.stats.cache_hits.values()))
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Executes a module with one kernel anew and calls it; whether the kernel came from its file."""
    module, folder = tmp_path / "module.py", tmp_path / "kept"
    module.write_text(KERNEL)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(folder))

    def once():
        kernel = runpy.run_path(str(module))["twice"]
        assert kernel(21) == 42
        return bool(sum(kernel.stats.cache_hits.values()))

    assert not once()
    assert once()
    return once, folder


@pytest.mark.slow
def test_files_that_are_cut_short_are_made_again(run):
    once, folder = run
    for pattern, size in (("*.nbi", 0), ("*.nbc", 0), ("*.nbc", 500)):
        for file in folder.rglob(pattern):
            with file.open("r+b") as opened:
                opened.truncate(size)
        assert not once()
        assert once()


@pytest.mark.slow
def test_files_that_cannot_be_written_are_done_without(run):
    once, folder = run
    for file in folder.rglob("*.nbi"):
        file.unlink()
        file.mkdir()
    assert not once()
    shutil.rmtree(folder)
    folder.write_text("no folder")
    once()  # wherever numba keeps it now


def test_a_full_disk_costs_the_file_of_a_kernel_and_not_the_kernel():
    def fail(*_):
        raise OSError(28, "No space left on device")

    function = numba.njit(cache=True)(lambda x: x + 1)
    function._cache._cache_file.save = function._cache._cache_file.load = fail
    assert forgiving(function)(1) == 2


@pytest.mark.slow
def test_of_processes_that_need_a_kernel_at_once_one_compiles_it(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    command = [sys.executable, program, tmp_path / "kept"]
    started = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    answers = [process.communicate(timeout=120)[0].split() for process in started]
    assert sorted(answers) == [["42", "0"], ["42", "1"], ["42", "1"]]


def test_a_process_that_is_stopped_over_a_kernel_keeps_no_other_for_ever(tmp_path, monkeypatch):
    monkeypatch.setattr("harness.kernel_cache.LONGEST_WAIT", 0.1)
    hold = (
        "import sys; from harness.kernel_cache import _Turn; _Turn(sys.argv[1], 'f').wait(); print(flush=True); input()"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", hold, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    holder.stdout.readline()
    turn = _Turn(str(tmp_path), "f")
    turn.wait()
    turn.wait()  # nor is it kept by itself
    turn.end()
    holder.communicate("\n")
    _Turn(str(tmp_path / "file" / "none"), "f").end()


def test_a_user_without_a_home_has_no_cache(monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert user_cache() is not None

    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr("harness.kernel_cache.Path.home", homeless)
    assert user_cache() is None


@pytest.mark.slow
def test_a_folder_belongs_to_a_module_and_all_that_it_imports():
    for module in ("harness.broadphase.grid", "harness.narrowphase.gap_pairs", "harness.motion.predictive.flight"):
        program = f"import sys, {module}; print(*(m for m in sys.modules if m.startswith('harness.')))"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        imported = {PACKAGE.joinpath(*name.split(".")[1:]) for name in done.stdout.split()}
        read = {file.parent if file.name == "__init__.py" else file.with_suffix("") for file in all_sources(module)}
        # the packages on the way to a module hold no kernel
        assert {place for place in imported if not place.is_dir()} <= read
    assert PACKAGE / "broadphase" / "grid.py" not in all_sources("harness.narrowphase.gap_pairs")
    assert all_sources("a_stranger") >= all_sources("harness.broadphase.grid") | all_sources("harness.motion.law")

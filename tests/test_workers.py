"""Tasks shared out among processes: each done once, what they raise comes back, and none is left behind."""

import os
import time

import psutil
import pytest

from harness.child_process import Child, Ending
from harness.errors import InputError
from harness.workers import shared_out


def test_each_task_is_done_once_and_begun_in_order_whoever_does_it():
    begun = []
    tasks = [lambda place=place: (place * place, os.getpid()) for place in range(9)]
    done = dict(shared_out(tasks, 3, begun.append))
    assert {place: found for place, (found, _) in done.items()} == {place: place * place for place in range(9)}
    assert begun == list(range(9))
    assert os.getpid() not in {process for _, process in done.values()}


def test_two_tasks_are_at_work_at_the_same_time(tmp_path):
    """Each waits for the file of the other, which neither would see if they were done one after another."""

    def meet(mine, other):
        (tmp_path / mine).touch()
        deadline = time.monotonic() + 20
        while not (tmp_path / other).exists() and time.monotonic() < deadline:
            time.sleep(0.005)
        return (tmp_path / other).exists()

    assert dict(shared_out([lambda: meet("a", "b"), lambda: meet("b", "a")], 2)) == {0: True, 1: True}


def test_nothing_to_do_starts_nothing():
    assert list(shared_out([], 4)) == []


def wrong_input():
    raise InputError("it is wrong")


def wrong_program():
    raise KeyError("nothing there")


@pytest.mark.parametrize(
    ("task", "kind", "told"),
    [
        (wrong_input, InputError, "it is wrong"),
        (wrong_program, RuntimeError, "nothing there"),
        (lambda: os._exit(3), RuntimeError, "exit code 3"),
        (lambda: os.kill(os.getpid(), 11), RuntimeError, "SIGSEGV"),
    ],
)
def test_what_goes_wrong_in_a_task_is_raised_here(task, kind, told):
    with pytest.raises(kind, match=told):
        list(shared_out([task], 1))


def test_a_task_may_have_several_children_at_a_time():
    def two():
        with Child.fork(lambda channel: channel.send(b"1")) as one, Child.fork(lambda _: time.sleep(100)) as other:
            told = one.receive(20)
            one.end()
            assert psutil.Process(other.pid).is_running()
        return told, other.end()

    assert dict(shared_out([two], 1)) == {0: (b"1", Ending(-9))}


def test_leaving_early_ends_what_is_at_work_and_all_that_it_has_started():
    def hang():
        if os.fork() == 0:
            os.setsid()
        time.sleep(1000)

    before = psutil.Process().children(recursive=True)  # other tests may have left helpers of theirs
    results = shared_out([lambda: "quick", hang, hang], 2)
    assert next(results) == (0, "quick")
    results.close()
    assert psutil.Process().children(recursive=True) == before

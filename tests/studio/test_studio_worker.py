"""The solving thread: the newest wish wins, prices wait, saving is never stopped."""

from __future__ import annotations

import threading
import time

import pytest

from actuator_opt.studio.worker import Dropped, Worker


@pytest.fixture
def worker():
    """A worker that is closed afterwards."""
    one = Worker()
    yield one
    one.close()


class Slow:
    """A job that runs until it is stopped or released; it says when it began."""

    def __init__(self):
        self.began, self.free, self.stopped = threading.Event(), threading.Event(), False

    def __call__(self, stop):
        """Wait; raise `Dropped` once stopped."""
        self.began.set()
        while not self.free.wait(0.002):
            if stop():
                self.stopped = True
                raise Dropped
        return "done"


def asked(worker, work, **how):
    """Ask in a thread; the list gets the result or the error's type."""
    found = []

    def run():
        try:
            found.append(worker.do(work, **how))
        except Exception as error:
            found.append(type(error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread, found


def waiting(worker, count):
    """Wait until so many jobs wait."""
    until = time.monotonic() + 5
    while len(worker._waiting) != count:
        assert time.monotonic() < until
        time.sleep(0.001)


def test_a_newer_wish_stops_the_running_one_and_drops_the_waiting(worker):
    """Of three wishes of a page only the last is answered, and prices asked before go, too."""
    slow, other = Slow(), Slow()
    first = asked(worker, slow, tab="a", kind="solve")
    assert slow.began.wait(5)
    kept = asked(worker, other, kind="kept")
    waiting(worker, 1)
    second = asked(worker, lambda stop: 2, tab="a", kind="prices")
    waiting(worker, 2)
    assert worker.do(lambda stop: 3, tab="a", kind="solve") == 3
    first[0].join(5)
    second[0].join(5)
    assert slow.stopped
    assert first[1] == second[1] == [Dropped]
    other.free.set()
    kept[0].join(5)
    assert kept[1] == ["done"]


def test_a_wish_stops_prices_of_any_page_but_no_wish_of_another(worker):
    """Two pages: prices wait for whoever drags; a drag waits for the other page's drag."""
    prices, drag = Slow(), Slow()
    first = asked(worker, prices, tab="a", kind="prices")
    assert prices.began.wait(5)
    second = asked(worker, drag, tab="b", kind="solve")
    assert drag.began.wait(5)
    first[0].join(5)
    assert first[1] == [Dropped]
    third = asked(worker, lambda stop: 3, tab="a", kind="solve")
    waiting(worker, 1)
    drag.free.set()
    third[0].join(5)
    second[0].join(5)
    assert (second[1], third[1], drag.stopped) == (["done"], [3], False)


def test_saving_is_never_stopped(worker):
    """A newer wish of the same page waits until the file is written."""
    slow = Slow()
    first = asked(worker, slow, tab="a", kind="kept")
    assert slow.began.wait(5)
    second = asked(worker, lambda stop: 2, tab="a", kind="solve")
    waiting(worker, 1)
    slow.free.set()
    first[0].join(5)
    second[0].join(5)
    assert (first[1], second[1]) == (["done"], [2])


def test_faults_reach_who_asked_and_the_thread_lives_on(worker):
    """The next job is run."""
    with pytest.raises(ZeroDivisionError):
        worker.do(lambda stop: 1 / 0)
    assert worker.do(lambda stop: 4) == 4


def test_closing_stops_and_drops(worker):
    """Nobody waits for ever."""
    slow = Slow()
    first = asked(worker, slow, kind="solve")
    assert slow.began.wait(5)
    second = asked(worker, lambda stop: 2)
    waiting(worker, 1)
    worker.close()
    first[0].join(5)
    second[0].join(5)
    assert first[1] == second[1] == [Dropped]
    with pytest.raises(Dropped):
        worker.do(lambda stop: 1)

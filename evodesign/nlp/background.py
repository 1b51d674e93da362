"""Work done in the background of what a process does: one piece after the other, until the process ends.

It is for compilers, which are processes of their own: this one waits for them in a thread.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future
from functools import cache
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

T = TypeVar("T")
Orders = SimpleQueue[tuple[Future[Any], Callable[[], Any]]]


def in_background(work: Callable[[], T]) -> Future[T]:
    """The result of work, when it is done; never, if the process ends or forks before."""
    future: Future[T] = Future()
    _orders().put((future, work))
    return future


@cache
def _orders() -> Orders:
    orders: Orders = SimpleQueue()
    Thread(target=_work, args=(orders,), name="background", daemon=True).start()
    return orders


os.register_at_fork(after_in_child=_orders.cache_clear)


def _work(orders: Orders) -> None:
    while True:
        future, work = orders.get()
        try:
            future.set_result(work())
        except Exception as error:  # noqa: BLE001 - whoever asks for the result is told
            future.set_exception(error)

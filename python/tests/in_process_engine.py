"""An engine in place of Ray, which runs tasks in this process and finishes them in any order."""

import pickle
import random

import numpy as np
from impinge.cluster import _calls, _parcels, _scenes, _session


class Engine:
    """The functions of Ray that are used. Arguments and answers are pickled."""

    class exceptions:  # noqa: N801 (the name of Ray's module)
        class RayError(Exception):
            pass

        class RayTaskError(RayError):
            cause = None

    def __init__(self):
        self.random = random.Random(5)
        self.started = []

    def remote(self, **_):
        return lambda function: Remote(self, function)

    def put(self, value):
        return bytes(value)

    def wait(self, references, num_returns, timeout=None):
        ready = (
            list(references) if timeout is None else self.random.sample(references, self.random.randint(1, num_returns))
        )
        return ready, []

    def get(self, reference):
        try:
            return pickle.loads(pickle.dumps(reference()))
        except Exception as error:
            raised = self.exceptions.RayTaskError()
            raised.cause = error
            raise raised from error

    def cancel(self, reference):
        pass

    def cluster_resources(self):
        return {"CPU": 3.0}


class Remote:
    def __init__(self, engine, function):
        self.engine, self.function = engine, function

    def options(self, name):
        self.engine.started.append(name)
        return self

    def remote(self, version, function, places, arguments, *parcels):
        contents = [np.frombuffer(parcel, np.uint8) for parcel in parcels]
        pickled = pickle.dumps((version, function, places, arguments))
        return lambda: self.function(*pickle.loads(pickled), *contents)


def cluster_of_tasks(monkeypatch, shared=None):
    """Returns a cluster without Ray, whose calls are cut into as many tasks as possible."""
    monkeypatch.setattr(_calls, "_MIN_WORK", 1)
    monkeypatch.setattr(_calls, "_TARGET_TASKS", 7)
    monkeypatch.setattr(_scenes, "_MIN_COST", 1 << 11)
    monkeypatch.setattr(_parcels, "_PARCEL_BYTES", 1 << 16)
    return _session.Cluster(Engine(), None, shared)

"""Runs calls on the machines of a Ray cluster, with the same answers, byte for byte.

::

    with impinge.cluster.ray(address="auto") as cluster:
        report = scene.check(poses, stop="all", on=cluster)
        hits = impinge.intersects(a, b, pose_b=poses, on=cluster)

Ray starts the tasks, moves the data and repeats what is lost. Install it with
``pip install "impinge[ray]"``. ``python -m impinge.cluster pairs SCENE`` is the command line.
"""

from impinge.cluster._session import Cluster, ClusterError, Work, ray

__all__ = ["Cluster", "ClusterError", "Work", "ray"]

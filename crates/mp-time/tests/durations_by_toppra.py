"""Writes toppra_durations.csv: how long the package `toppra` of PyPI takes along 200 random paths of seven joints.

    pip install toppra numpy && python durations_by_toppra.py > toppra_durations.csv

The paths and limits are those that by_toppra.rs makes of the same seeds.
"""

import math

import numpy
import toppra
from toppra import algorithm, constraint
from toppra.interpolator import AbstractGeometricPath

JOINTS, WAVES, POINTS = 7, 3, 101


class Numbers:
    """Numbers in [0, 1): a linear congruential generator."""

    def __init__(self, seed):
        self.state = seed

    def next(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % 2**64
        return (self.state >> 11) / 2**53


class Waves(AbstractGeometricPath):
    """A sum of sines for each joint."""

    def __init__(self, numbers):
        self.waves = [
            [(numbers.next() - 0.5, k + 1.0, 2.0 * math.pi * numbers.next()) for k in range(WAVES)]
            for _ in range(JOINTS)
        ]

    def __call__(self, s, order=0):
        shift = order * math.pi / 2
        rows = [
            sum(a * k**order * numpy.sin(k * numpy.asarray(s) + phase + shift) for a, k, phase in joint)
            for joint in self.waves
        ]
        return numpy.array(rows).T

    @property
    def dof(self):
        return JOINTS

    @property
    def path_interval(self):
        return numpy.array([0.0, 2.0])

    @property
    def waypoints(self):
        return None


def duration(seed):
    numbers = Numbers(seed)
    path = Waves(numbers)
    velocity = numpy.array([0.5 + 1.5 * numbers.next() for _ in range(JOINTS)])
    acceleration = numpy.array([1.0 + 3.0 * numbers.next() for _ in range(JOINTS)])
    limits = [
        constraint.JointVelocityConstraint(numpy.array([-velocity, velocity]).T),
        constraint.JointAccelerationConstraint(
            numpy.array([-acceleration, acceleration]).T,
            discretization_scheme=constraint.DiscretizationType.Interpolation,
        ),
    ]
    points = numpy.linspace(0.0, 2.0, POINTS)
    solver = algorithm.TOPPRA(limits, path, gridpoints=points, solver_wrapper="seidel")
    _, speeds, _ = solver.compute_parameterization(0.0, 0.0)
    return float(sum(2.0 * numpy.diff(points) / (speeds[1:] + speeds[:-1])))


if __name__ == "__main__":
    toppra.setup_logging("WARNING")
    print("seed,duration [s]")
    for seed in range(200):
        print(f"{seed},{duration(seed)!r}")

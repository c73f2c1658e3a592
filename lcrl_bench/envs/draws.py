"""`Draws`: a random generator per sub-environment, as each single environment has one."""

from __future__ import annotations

import numpy as np
from gymnasium.utils import seeding


class Draws:
    """Generators that are seeded on demand, at random if nobody says otherwise."""

    def __init__(self, environments: int) -> None:
        """Start with nothing seeded; `environments` is the number of sub-environments."""
        self._generators: list[np.random.Generator | None] = [None] * environments
        self._seeds: list[int] = [-1] * environments

    def seed(self, number: int, seed: int | None) -> None:
        """Seed the generator of a sub-environment; None seeds it at random."""
        self._generators[number], self._seeds[number] = seeding.np_random(seed)

    def below(self, number: int, limit: int) -> int:
        """An integer from 0 to below the limit, drawn for a sub-environment."""
        generator = self._generators[number]
        return int((generator or self.generator(number)).integers(limit))

    def generator(self, number: int) -> np.random.Generator:
        """The generator of a sub-environment."""
        generator = self._generators[number]
        if generator is None:
            self.seed(number, None)
            return self.generator(number)
        return generator

    @property
    def generators(self) -> tuple[np.random.Generator, ...]:
        """The generator of each sub-environment."""
        return tuple(map(self.generator, range(len(self._generators))))

    @property
    def seeds(self) -> tuple[int, ...]:
        """The seed of each sub-environment."""
        return tuple(self._seeds[number] for number, _ in enumerate(self.generators))

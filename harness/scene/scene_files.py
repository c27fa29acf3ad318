"""The files that a scene is made of, opened."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, TypeAlias

from harness.scene.mesh import Mesh
from harness.scene.recorded_poses import RecordedPoses

Opened: TypeAlias = Mapping[Path, Mesh | RecordedPoses]
"""What was read of the files that experiments name, by their paths."""


class SceneFiles(NamedTuple):
    """What was read of the files that one scene names.

    Attributes
    ----------
    meshes : in the order in which the scene first names them
    poses : recorded, where the bodies do not fly by the laws of this program
    """

    meshes: tuple[Mesh, ...] = ()
    poses: RecordedPoses | None = None

    @property
    def parts(self) -> tuple[Mesh | RecordedPoses, ...]:
        """All of them."""
        return self.meshes if self.poses is None else (*self.meshes, self.poses)

    @property
    def identities(self) -> tuple[str, ...]:
        """By which they are the same as others."""
        return tuple(part.identity for part in self.parts)

    @classmethod
    def of(cls, parts: tuple[Mesh | RecordedPoses, ...]) -> SceneFiles:
        """From its parts, as `parts` has them."""
        meshes = tuple(part for part in parts if isinstance(part, Mesh))
        return cls(meshes, next((part for part in parts if isinstance(part, RecordedPoses)), None))

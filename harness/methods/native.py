"""A backend's own pipeline as a whole: its stages are not known, so that none can be left out."""

from __future__ import annotations

from harness.backends import registry
from harness.backends.all_but_ignored import AllButIgnored
from harness.backends.protocol import Backend
from harness.backends.statement import approximation
from harness.errors import InputError
from harness.methods.stages import Plan
from harness.methods.stepped import SteppedMethod
from harness.methods.stepping import Detector
from harness.scene.scene import Scene


class Native(SteppedMethod):
    """Asks a backend for all touching pairs."""

    def backend(self) -> Backend:
        """A new backend, not loaded yet."""
        return registry.create(self.name.backend)

    def finding(self, count: int) -> str:
        return f"{self.name.backend} finds the touching pairs by itself"

    def warnings(self, scene: Scene) -> tuple[str, ...]:
        replaced = approximation(self.name.backend, scene.shape) if len(scene.bodies) > 1 else None
        return (f"APPROXIMATION: {replaced}",) if replaced else ()

    def detector(self, scene: Scene, plan: Plan) -> Detector:
        backend = self.backend()
        if scene.shape not in backend.shapes:
            raise InputError(f'backend "{backend.name}" has no shape {scene.shape}, only {", ".join(backend.shapes)}')
        backend.load(scene)
        return AllButIgnored(backend, scene.ignored) if len(scene.ignored) else backend


METHOD = Native

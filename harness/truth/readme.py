"""The README of a set: what the columns mean, what is assumed, what is proven, and a reader in plain Python."""

from __future__ import annotations

from collections import Counter

import numpy as np

from harness.truth.cases import Cases
from harness.truth.declaration import TruthDeclaration

_TEXT = """# {title}

{question}

Pairs of rigid bodies at constant velocity and constant spin, and when they begin to touch, proven. {number} cases:
{touching} touch, {at_start} of them at the start; {never} never do in their window.

| family | cases | touch | declared |
|---|---|---|---|
{families}

{left_out}

## What is in the folder

`cases.csv` has a case a row; `meshes/` has the surfaces as OBJ files with nothing but `v` and `f` lines.

| column | means |
|---|---|
| `family` | how the pair was drawn |
| `shape` | of both bodies: see below |
| `mesh_a`, `mesh_b` | the file `meshes/NAME.obj`; empty for a sphere |
| `size_a`, `size_b` | factor on the vertices of the file, m: about the diameter of the bounding sphere |
| `x_a` … `z_a` | m, where the body's origin is at time 0 |
| `qw_a` … `qz_a` | quaternion of the turn at time 0; it need not be of length 1, and is divided by its length |
| `vx_a` … `vz_a` | m/s, velocity |
| `wx_a` … `wz_a` | rad/s, angular velocity in the axes of the world |
| … `_b` | the same of the second body |
| `window` | s: what happens later is not said |
| `lower`, `upper` | s: nothing touches from 0 to `lower`, and at `upper` the bodies touch; {widest:g} s apart at most |
| `verdict` | `touches`, or `never`: then `lower` is the window and `upper` is empty |

## What is assumed

A point p of a mesh is at x + v t + exp(w t) (q / |q|) (size p) at the time t: bodies are rigid, move at constant
velocity and constant angular velocity, feel no force and pass through each other. The numbers are the double
precision numbers nearest to the decimals of the table. Touching is having a common point, so a gap of 0 touches.
Where `lower` and `upper` are both 0, the bodies touch at the start.

The shape `mesh` is the surface, without what it encloses: inside another one, it does not touch it. `hull` is the
convex hull of the vertices, solid; `sphere` is a solid ball of diameter `size`.

## What is proven, and how

`harness truth check` proves every row anew, by code that shares nothing with any engine. That nothing touches until
`lower`: a tree of cells, of parts of both surfaces and intervals of time, for each of which an axis is found along
which the parts stay apart by more than all roundings can amount to. That the bodies touch at `upper`: two triangles,
an edge of one of which runs through the other, in integers of 256 bits with a bound on their error, or in fractions
where nothing turns. It is assumed that the machine rounds as IEEE 754 says, that its sines and cosines err by at most
4 units in the last place, and, for hulls, that the faces that Qhull finds are within 1e-13 of a size of the hull.

## A reader in plain Python

```python
{reader}```
"""

READER = '''\
import csv

def body(row, side, folder):
    """What a body is and how it moves: mesh, size, position, quaternion (w x y z), velocity, spin."""
    def numbers(*names):
        return [float(row[f"{name}_{side}"]) for name in names]
    vertices, faces = [], []
    if row[f"mesh_{side}"]:
        for line in open(f"{folder}/meshes/{row[f'mesh_{side}']}.obj"):
            kind, *rest = line.split()
            if kind == "v":
                vertices.append([float(number) for number in rest])
            else:
                faces.append([int(corner) - 1 for corner in rest])
    return (vertices, faces), *numbers("size"), numbers(*"xyz"), numbers("qw", "qx", "qy", "qz"), \\
        numbers("vx", "vy", "vz"), numbers("wx", "wy", "wz")

def cases(folder):
    for row in csv.DictReader(open(f"{folder}/cases.csv")):
        bounds = float(row["lower"]), float(row["upper"] or "inf")
        yield row["family"], row["shape"], body(row, "a", folder), body(row, "b", folder), float(row["window"]), bounds
'''


def readme(declaration: TruthDeclaration, cases: Cases, left_out: int, moved: int, widest: float) -> str:
    """The text.

    Parameters
    ----------
    declaration : what was asked for
    cases : what was made
    left_out : drafts that could not be proven, and were drawn anew
    moved : cases whose bounds are not where the engine that proposed them said
    widest : s, between both bounds
    """
    touches = np.isfinite(cases.upper)
    made, touching = Counter(cases.families.tolist()), Counter(cases.families[touches].tolist())
    rows = [
        f"| {name} | {made[name]} | {touching[name]} | {family.count} |"
        for name, family in declaration.families.items()
    ]
    return _TEXT.format(
        title=declaration.spec.title,
        question=declaration.spec.question or "When do two bodies begin to touch?",
        number=cases.number,
        touching=int(touches.sum()),
        at_start=int((cases.upper == 0.0).sum()),
        never=int((~touches).sum()),
        families="\n".join(rows),
        left_out=f"Of the pairs drawn, {left_out} could not be proven, or touch at the very end of their window; other "
        f"ones were drawn in\ntheir place. The engine of harness proposed where to look; of {moved} cases it was "
        f"off by more than {widest:g} s, and the bounds\nwere found without it.",
        widest=widest,
        reader=READER,
    )

"""What a hit does to velocities. The normal is the line of centres; only approaching spheres are answered."""

from __future__ import annotations

from harness.kernel import step
from harness.motion.predictive.state import MASS, VX, Floats, X


@step
def bounce(rows: Floats, book: Floats, i: int, j: int, restitution: float) -> tuple[float, float]:
    """Equal and opposite impulses; both rows stand at the same time.

    Returns |impulse| times the distance of centres (kg m^2/s) and the kinetic energy lost (J).
    """
    gap_x, gap_y, gap_z = rows[j, X] - rows[i, X], rows[j, X + 1] - rows[i, X + 1], rows[j, X + 2] - rows[i, X + 2]
    approach = (
        gap_x * (rows[j, VX] - rows[i, VX])
        + gap_y * (rows[j, VX + 1] - rows[i, VX + 1])
        + gap_z * (rows[j, VX + 2] - rows[i, VX + 2])
    )
    # Divided by the actual square of the distance, not by the touching one: energy is then exact whatever the overlap.
    square = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z
    total = book[i, MASS] + book[j, MASS]
    share_i, share_j = book[j, MASS] / total, book[i, MASS] / total
    kick = (1.0 + restitution) * (approach / square)
    rows[i, VX] += share_i * kick * gap_x
    rows[i, VX + 1] += share_i * kick * gap_y
    rows[i, VX + 2] += share_i * kick * gap_z
    rows[j, VX] -= share_j * kick * gap_x
    rows[j, VX + 1] -= share_j * kick * gap_y
    rows[j, VX + 2] -= share_j * kick * gap_z
    reduced = book[i, MASS] * share_i
    lost = 0.5 * reduced * (1.0 - restitution * restitution) * (approach * (approach / square))
    return -(1.0 + restitution) * reduced * approach, lost


@step
def flip(rows: Floats, book: Floats, i: int, j: int) -> float:
    """Each velocity is mirrored in the plane across the line of centres. Returns the pair's share of the virial."""
    gap_x, gap_y, gap_z = rows[j, X] - rows[i, X], rows[j, X + 1] - rows[i, X + 1], rows[j, X + 2] - rows[i, X + 2]
    square = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z
    return mirror(rows, book, i, gap_x, gap_y, gap_z, square) + mirror(rows, book, j, gap_x, gap_y, gap_z, square)


@step
def mirror(rows: Floats, book: Floats, k: int, x: float, y: float, z: float, square: float) -> float:
    """Mirror velocity k along the normal (x, y, z), of that square.

    Returns its change of momentum times its position.
    """
    kick = -2.0 * ((rows[k, VX] * x + rows[k, VX + 1] * y + rows[k, VX + 2] * z) / square)
    rows[k, VX] += kick * x
    rows[k, VX + 1] += kick * y
    rows[k, VX + 2] += kick * z
    return float(book[k, MASS] * kick * (x * rows[k, X] + y * rows[k, X + 1] + z * rows[k, X + 2]))

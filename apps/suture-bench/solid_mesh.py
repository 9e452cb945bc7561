# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of hexahedra for Suture and CalculiX: boxes, bodies of voxels, slits, and the nodes of quadratic elements."""
import dataclasses
import math

# The corners of CalculiX's element in X0..X7, and its edges and sides in its own corners.
CORNER_ORDER = (0, 1, 3, 2, 4, 5, 7, 6)
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
# Four corners around a side, then the nodes between them.
SIDES = ((0, 1, 2, 3, 8, 9, 10, 11), (4, 5, 6, 7, 12, 13, 14, 15), (0, 1, 5, 4, 8, 17, 12, 16),
         (1, 2, 6, 5, 9, 18, 13, 17), (2, 3, 7, 6, 10, 19, 14, 18), (3, 0, 4, 7, 11, 16, 15, 19))


@dataclasses.dataclass
class Mesh:
    """Points, hexahedra by their corners X0..X7 (x fastest), and sets of points by name."""
    points: list
    hexahedra: list
    sets: dict = dataclasses.field(default_factory=dict)


def ticks(begin, size, n, grading=1):
    """The nodes of n cells, the last `grading` >= 1 times as long as the first:
    S_i = (r^i - 1) / (r^n - 1), r^(n-1) = grading."""
    if n == 1 or grading == 1:
        return [(begin * (n - i) + (begin + size) * i) / n for i in range(n + 1)]
    log_r = math.log(grading) / (n - 1)
    shares = [math.expm1(i * log_r) / math.expm1(n * log_r) for i in range(n + 1)]
    return [begin * (1 - s) + (begin + size) * s for s in shares]


def box_mesh(size, cells, origin=(0, 0, 0), grading=(1, 1, 1)):
    """As the box of a scene: numbered along x, then y, then z; sets x0 to z1."""
    x, y, z = (ticks(*of_axis) for of_axis in zip(origin, size, cells, grading))
    mesh = Mesh([(a, b, c) for c in z for b in y for a in x], [])
    counts = [n + 1 for n in cells]
    row, layer = counts[0], counts[0] * counts[1]
    for k in range(cells[2]):
        for j in range(cells[1]):
            for p in range(row * j + layer * k, row * j + layer * k + cells[0]):
                mesh.hexahedra.append((p, p + 1, p + row, p + row + 1, p + layer, p + layer + 1,
                                       p + layer + row, p + layer + row + 1))
    for axis, stride in enumerate((1, row, layer)):
        for side, at in enumerate((0, cells[axis])):
            mesh.sets[f"{'xyz'[axis]}{side}"] = [
                p for p in range(len(mesh.points)) if p // stride % counts[axis] == at]
    return mesh


def divided(coarse, n):
    """Every hexahedron in n x n x n parts. Points are known by the corners around them, with their weights."""
    fine, numbers = Mesh([], []), {}

    def point(corners, at):
        weights = tuple(sorted(
            (corner, weight) for i, corner in enumerate(corners)
            if (weight := math.prod(a if i >> c & 1 else n - a for c, a in enumerate(at))) > 0))
        if weights not in numbers:
            numbers[weights] = len(fine.points)
            fine.points.append(tuple(
                sum(coarse.points[corner][c] * weight / n**3 for corner, weight in weights) for c in range(3)))
        return numbers[weights]

    for corners in coarse.hexahedra:
        for part in range(n**3):
            low = (part % n, part // n % n, part // n**2)
            fine.hexahedra.append(tuple(
                point(corners, tuple(a + (i >> c & 1) for c, a in enumerate(low))) for i in range(8)))
    return fine


def write_gmsh(file, mesh):
    """Format 2.2; sets are physical groups of points."""
    with open(file, "w", encoding="ascii") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
        if mesh.sets:
            out.write(f"$PhysicalNames\n{len(mesh.sets)}\n")
            out.writelines(f'0 {i} "{name}"\n' for i, name in enumerate(mesh.sets, 1))
            out.write("$EndPhysicalNames\n")
        out.write(f"$Nodes\n{len(mesh.points)}\n")
        out.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(mesh.points, 1))
        elements = [f"15 2 {group} {group} {p + 1}" for group, points in enumerate(mesh.sets.values(), 1)
                    for p in points]
        elements += ["5 2 0 1 " + " ".join(str(corners[i] + 1) for i in CORNER_ORDER)
                     for corners in mesh.hexahedra]
        out.write(f"$EndNodes\n$Elements\n{len(elements)}\n")
        out.writelines(f"{i} {text}\n" for i, text in enumerate(elements, 1))
        out.write("$EndElements\n")


class SolidMesh:
    """Hexahedra with 8 or 20 nodes in CalculiX's order: corners, then the middles of the edges below, above and
    between. Nodes at corners come first and have the numbers of the mesh. `nodes`: the two corners that a node lies
    between; at a corner, the same one twice."""

    def __init__(self, mesh, quadratic):
        self.quadratic = quadratic
        self.points = list(mesh.points)
        self.nodes = [(v, v) for v in range(len(mesh.points))]
        self.elements = []
        middles = {}
        for hexahedron in mesh.hexahedra:
            element = [hexahedron[i] for i in CORNER_ORDER]
            for i, j in EDGES if quadratic else ():
                ends = min(element[i], element[j]), max(element[i], element[j])
                if ends not in middles:
                    middles[ends] = len(self.nodes)
                    self.nodes.append(ends)
                    self.points.append(tuple((a + b) / 2 for a, b in zip(*(mesh.points[v] for v in ends))))
                element.append(middles[ends])
            self.elements.append(element)

    def elements_of_sides(self):
        found = {}
        for e, element in enumerate(self.elements):
            for side in SIDES:
                found.setdefault(name_of_side(element, side), []).append(e)
        return found

    def loaded_nodes(self, is_selected):
        """Forces at nodes equivalent to a uniform traction of 1 Pa on the sides that belong to one element only and
        whose corners are all selected, m^2."""
        owners, sums = self.elements_of_sides(), {}
        for element in self.elements:
            for side in SIDES:
                name = name_of_side(element, side)
                if len(owners[name]) > 1 or not all(is_selected(v) for v in name):
                    continue
                parts = shares([self.points[element[i]] for i in side[:4]], self.quadratic)
                for i, area in zip(side, parts):
                    sums[element[i]] = sums.get(element[i], 0) + area
        return sorted(sums.items())


def name_of_side(element, side):
    """The same for every element that has the side."""
    return tuple(sorted(element[i] for i in side[:4]))


# Shape functions of a side with four nodes, and with eight (serendipity), at (a, b) in [-1, 1]^2:
#   N_i = (1 + a a_i) (1 + b b_i) / 4
#   N_i = (1 + a a_i) (1 + b b_i) (a a_i + b b_i - 1) / 4 at corners,
#   N_i = (1 - a^2) (1 + b b_i) / 2 and (1 + a a_i) (1 - b^2) / 2 between them.
PLACES = ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0))


def bilinear(i, a, b):
    return (1 + a * PLACES[i][0]) * (1 + b * PLACES[i][1]) / 4


def serendipity(i, a, b):
    x, y = a * PLACES[i][0], b * PLACES[i][1]
    if i < 4:
        return (1 + x) * (1 + y) * (x + y - 1) / 4
    return (1 - a * a) * (1 + y) / 2 if i % 2 == 0 else (1 + x) * (1 - b * b) / 2


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def area_at(corners, a, b):
    """Area per (a, b) of the side with these corners."""
    along, across = ([sum(slope(p, q) * x[c] for (p, q), x in zip(PLACES, corners)) for c in range(3)]
                     for slope in (lambda p, q: p * (1 + b * q) / 4, lambda p, q: q * (1 + a * p) / 4))
    normal = cross(along, across)
    return math.sqrt(dot(normal, normal))


def shares(corners, quadratic):
    """The integral of each shape function over a side, by 3 x 3 Gauss points."""
    rule = ((-math.sqrt(0.6), 5 / 9), (0, 8 / 9), (math.sqrt(0.6), 5 / 9))
    result = [0.0] * (8 if quadratic else 4)
    for b, b_weight in rule:
        for a, a_weight in rule:
            area = a_weight * b_weight * area_at(corners, a, b)
            for i in range(len(result)):
                result[i] += area * (serendipity if quadratic else bilinear)(i, a, b)
    return result


def with_slit(mesh, cut):
    """The mesh after cutting the faces between pairs of elements: the elements around a node share it as long as
    uncut faces connect them."""
    if not cut:
        return mesh
    solid = SolidMesh(mesh, False)
    cut = {tuple(sorted(pair)) for pair in cut}
    # Copies of nodes at elements' corners that uncut faces connect are one: union-find over (element, node).
    parent = {(e, v): (e, v) for e, element in enumerate(solid.elements) for v in element}

    def root(copy):
        while parent[copy] != copy:
            parent[copy] = copy = parent[parent[copy]]
        return copy

    for side, owners in solid.elements_of_sides().items():
        if len(owners) == 2 and tuple(owners) not in cut:
            for node in side:
                parent[root((owners[0], node))] = root((owners[1], node))
    points, hexahedra, owner, copies = list(mesh.points), [list(h) for h in mesh.hexahedra], {}, {}
    for e, hexahedron in enumerate(hexahedra):
        for i in CORNER_ORDER:
            node = hexahedron[i]
            group = root((e, node))
            if owner.setdefault(node, group) != group:
                if group not in copies:
                    copies[group] = len(points)
                    points.append(points[node])
                hexahedron[i] = copies[group]
    return Mesh(points, hexahedra, mesh.sets)

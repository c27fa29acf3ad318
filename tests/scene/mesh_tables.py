"""Tables of mesh files: what each is, its content, and its right area and volume, or the reason why it is not read."""

import struct

from tests.scene.mesh_samples import (
    CUBE,
    MIXED,
    TRIANGLES,
    Solid,
    changed,
    glb,
    glb_document,
    obj,
    off,
    ply,
    stl_binary,
    stl_text,
)

GLB = glb_document(TRIANGLES)
STL = stl_text(TRIANGLES)
BINARY_STL = stl_binary(TRIANGLES)
NORMALS = "vt 0 0\n" * 8 + "vn 0 0 1\n" * 8
# three cubes, each followed by faces that count backwards
BLOCKS = b"".join(obj(Solid([(x + k, y, z) for x, y, z in CUBE.vertices], *CUBE[1:]), corner="{1}") for k in (0, 2, 4))
TWO = [obj(Solid([(x + k, y, z) for x, y, z in CUBE.vertices], *CUBE[1:]), corner="{1}") for k in (0, 2)]
REPEATS = Solid(CUBE.vertices, [[a, b, c, c] for a, b, c in TRIANGLES.polygons], 6, 1)
HALVES = [Solid(CUBE.vertices, half, 3, 0) for half in (TRIANGLES.polygons[:6], TRIANGLES.polygons[6:])]
# an element before the vertices, these with a list of their own, and one behind the faces
CROWDED = (
    b"ply\nformat binary_big_endian 1.0\nelement camera 2\nproperty list uchar double view\nelement vertex 8\n"
    b"property uchar red\nproperty float x\nproperty list ushort short near\nproperty double y\nproperty float z\n"
    b"element face 6\nproperty float quality\nproperty list int uint vertex_index\nproperty list uchar float texcoord\n"
    b"element edge 1\nproperty int vertex1\nend_header\n"
    + struct.pack(">BdBdd", 1, 1.5, 2, 2.5, 3.5)
    + b"".join(struct.pack(f">BfH{k}hdf", 9, x, k, *range(k), y, z) for k, (x, y, z) in enumerate(CUBE.vertices))
    + b"".join(struct.pack(">fi4IB2f", 0.5, 4, *polygon, 2, 0.1, 0.2) for polygon in CUBE.polygons)
    + b"\0\1"
)
# two rows of an element between the vertices and the six faces, as text and binary
BETWEEN = [
    (content[:-faces] + rows + content[-faces:]).replace(
        b"element face", b"element gap 2\nproperty int id\nelement face"
    )
    for content, faces, rows in (
        (ply(CUBE), len("4 0 1 2 3\n") * 6, b"5\n7\n"),
        (ply(CUBE, "<"), struct.calcsize("<B4i") * 6, struct.pack("<2i", 5, 7)),
    )
]
FACES_FIRST = b"".join(sorted(obj(CUBE).splitlines(True), key=lambda line: line[:1]))
# each triangle of the cube, with steps without area in between that keep the sense of turning
FIRSTS = [a for a, _, _ in TRIANGLES.polygons[1:]] + [0]
STRIP = [n for (a, b, c), first in zip(TRIANGLES.polygons, FIRSTS, strict=True) for n in (a, b, c, c, c, first)]
TURNED = [{"children": [1], "translation": [5, 0, 0]}, {"mesh": 0, "rotation": [0, 0, 0.6, 0.8], "scale": [2, 3, 4]}]

# file, what it is, content, right area and volume
READ = [
    ("a.obj", "white space of all kinds", obj(CUBE, "  v\t{}  {}\t\t{}\x0b \n", "\tf\t{}  \n"), 6, 1),
    ("a.obj", "comments anywhere", b"#v\n" + obj(CUBE, "v {} {} {} # 1 2\n", "f {}#c\n"), 6, 1),
    ("a.obj", "a comment that ends in a backslash", b"# C:\\models\\\n" + obj(CUBE), 6, 1),
    ("a.obj", "lines continued", obj(CUBE, "v {} \\\n{} {}\n", "f {}\n", "{0} \\\n "), 6, 1),
    ("a.obj", "a byte-order mark before a vertex", b"\xef\xbb\xbf" + obj(CUBE), 6, 1),
    ("a.obj", "line ends of another system", obj(CUBE).replace(b"\n", b"\r\n"), 6, 1),
    ("a.obj", "line ends of an old system", obj(CUBE).replace(b"\n", b"\r"), 6, 1),
    ("a.obj", "spaces that do not break", obj(CUBE).replace(b" ", b"\xc2\xa0"), 6, 1),
    ("a.obj", "names in Latin-1", "o K\xfcrbis\ng \xd6l#1\nusemtl \xdf\n".encode("latin-1") + obj(CUBE), 6, 1),
    ("a.obj", "keywords in upper case", obj(CUBE, "V {} {} {}\n", "F {}\n"), 6, 1),
    ("a.obj", "vertices with a weight and colours", obj(CUBE, "v {} {} {} 1.0 .5 .5 .5\n"), 6, 1),
    ("a.obj", "no new line at its end", obj(CUBE).rstrip(), 6, 1),
    ("a.obj", "texture and normal", obj(CUBE, corner="{0}/{0}/{0}", before=NORMALS), 6, 1),
    ("a.obj", "negative indices with texture and normal", obj(CUBE, corner="{1}/{1}/{1}", before=NORMALS), 6, 1),
    ("a.obj", "negative indices with normal alone", obj(CUBE, corner="{1}//{1}", before=NORMALS), 6, 1),
    ("a.obj", "indices relative to where they stand", BLOCKS, 18, 3),
    ("a.obj", "faces before their vertices", FACES_FIRST, 6, 1),
    ("a.obj", "lines, points and curves beside faces", b"p 1\nl 1 2\nparm u 0 1\n" + obj(CUBE) + b"s off\n", 6, 1),
    ("a.obj", "polygons that repeat a corner", obj(REPEATS), 6, 1),
    ("a.obj", "faces of one and two corners", obj(CUBE) + b"f 1\nf 1 2\n", 6, 1),
    ("a.obj", "faces of the old name", obj(CUBE, face="fo {}\n"), 6, 1),
    ("a.obj", "two files with marks, one behind the other", b"".join(b"\xef\xbb\xbf" + part for part in TWO), 12, 2),
    ("a.obj", "a number that is none, of no face", obj(CUBE) + b"v 1.#QNAN -1.#IND00 1.#INF\n", 6, 1),
    ("a.ply", "mixed lengths", ply(MIXED), 6, 1),
    ("a.ply", "words behind the faces", ply(CUBE) + b"made by_a program\n", 6, 1),
    ("a.ply", "mixed lengths, binary", ply(MIXED, "<"), 6, 1),
    ("a.ply", "mixed lengths, binary, of other types", ply(MIXED, ">", "double", "ushort", "uint"), 6, 1),
    ("a.ply", "other elements, properties and lists", CROWDED, 6, 1),
    ("a.ply", "an element between vertices and faces", BETWEEN[0], 6, 1),
    ("a.ply", "an element between vertices and faces, binary", BETWEEN[1], 6, 1),
    ("a.ply", "bytes behind the faces", ply(CUBE, "<") + b"\0\1\2", 6, 1),
    ("a.ply", "a cut element behind the faces", ply(CUBE, "<", more="element edge 9\nproperty int a\n"), 6, 1),
    ("a.ply", "line ends of another system", ply(CUBE).replace(b"\n", b"\r\n"), 6, 1),
    ("a.ply", "binary, line ends of another system", b"\r\n".join(ply(CUBE, "<").split(b"\n", 9)), 6, 1),
    ("a.ply", "binary, line ends of an old system", b"\r".join(ply(CUBE, "<").split(b"\n", 10)), 6, 1),
    ("a.ply", "rows over several lines", ply(CUBE).replace(b"0.0 0.0", b"0.0\n0.0"), 6, 1),
    ("a.stl", "keywords in upper case", STL.upper(), 6, 1),
    ("a.stl", "a comment before the first keyword", b"# made by a program\n\n" + STL, 6, 1),
    ("a.stl", "a byte-order mark before it", b"\xef\xbb\xbf" + STL, 6, 1),
    ("a.stl", "a name in Latin-1", stl_text(TRIANGLES, "K\xfcrbis"), 6, 1),
    ("a.stl", "a name of keywords", stl_text(TRIANGLES, "facet vertex 1 2 3 endsolid"), 6, 1),
    ("a.stl", "several solids", b"".join(map(stl_text, HALVES)), 6, 1),
    ("a.stl", "all in one line", b" ".join(STL.split()), 6, 1),
    ("a.stl", "binary", BINARY_STL, 6, 1),
    ("a.stl", "binary that begins as text does", stl_binary(TRIANGLES, b"solid facet"), 6, 1),
    ("a.stl", "bytes beyond the announced faces", BINARY_STL + b"\xff" * 77, 6, 1),
    ("a.off", "colours", off(CUBE, "COFF\n{} {} 0\n", "{} {} {} 255 0 0 255\n", "{} {} 0.5 0.5 0.5\n"), 6, 1),
    ("a.off", "normals", off(CUBE, "NOFF\n{} {} 0\n", "{} {} {} 0 0 1\n"), 6, 1),
    ("a.off", "counts in the first line", off(CUBE, "OFF {} {} 0\n"), 6, 1),
    ("a.off", "counts without a space", off(CUBE, "OFF{} {} 0\n"), 6, 1),
    ("a.off", "no first word", off(CUBE, "{} {}\n"), 6, 1),
    ("a.off", "comments and empty lines", off(CUBE, "#\nOFF#\n\n{} {} 0\n", "{} {} {} # c\n\n", "{} {}\n#\n"), 6, 1),
    ("a.off", "lower case", off(CUBE, "off\r\n{} {} 0\r\n"), 6, 1),
    ("a.glb", "triangles", glb(*GLB), 6, 1),
    ("a.glb", "a strip", glb(*glb_document(CUBE, 5, STRIP)), 6, 1),
    ("a.glb", "placed by two nodes", changed(GLB, "nodes", TURNED), 52, 24),
]

# file, what it is, content, reason
REFUSED = [
    ("a.obj", "index 0", obj(CUBE, corner="{0}") + b"f 0 1 2\n", "line 15: a face names vertex 0; OBJ counts from 1"),
    ("a.obj", "index 0 in texture", obj(CUBE, face="f {} 0/1/1\n"), "line 9: a face names vertex 0"),
    ("a.obj", "index beyond the vertices", obj(CUBE) + b"f 1 2 9\n", "line 15: 1 of the mesh's faces name a vertex"),
    ("a.obj", "relative before the first", obj(CUBE) + b"f -9 1 2\n", "line 15: a face names vertex -9, and there"),
    ("a.obj", "two coordinates", b"# c\nv 1 2\n", "line 2: a vertex has 3 coordinates, not 2"),
    ("a.obj", "a decimal comma", b"v 1,5 2 3\n", 'line 1: "1,5" is not a number'),
    ("a.obj", "no whole number", obj(CUBE) + b"f 1 2 3.5\n", 'line 15: "3.5" is not the number of a vertex'),
    ("a.obj", "no finite number", obj(CUBE).replace(b"1.0 1.0 1.0", b"1 nan 1"), "line 7: 1 of the mesh's vertices"),
    (
        "a.obj",
        "an old compiler's NaN",
        obj(CUBE).replace(b"1.0 1.0 1.0", b"1 1 1.#QNAN"),
        "line 7: 1 of the mesh's ver",
    ),
    (
        "a.off",
        "an old compiler's NaN",
        off(CUBE).replace(b"1.0 1.0 1.0", b"1 1 -1.#IND"),
        "line 9: 1 of the mesh's ver",
    ),
    ("a.obj", "UTF-16", obj(CUBE).decode().encode("utf-16"), "this is UTF-16 text; save it as UTF-8"),
    ("a.obj", "UTF-16 without a mark", obj(CUBE).decode().encode("utf-16-be"), "this is UTF-16 text; save it as UTF-8"),
    ("a.obj", "points", b"v 0 0 0\nv 1 1 1\np 1 2\n", "it has no faces, only vertices, lines or points"),
    ("a.obj", "a free-form surface", b"v 0 0 0\nsurf 0 1 0 1 1\n", "line 2: free-form curves and surfaces"),
    ("a.obj", "another file called", b"call other.obj\n", "line 1: a file that calls another one is not read"),
    ("a.obj", "words", b"once upon a time\n", 'no OBJ file: line 1 begins with "once"'),
    ("a.obj", "empty", b"", "the file is empty"),
    ("a.obj", "binary", bytes(range(256)) * 9, "this is no text"),
    ("a.obj", "a pointer", b"version https://git-lfs.github.com/spec/v1\n", "a pointer of Git LFS, not the mesh"),
    ("a.obj", "a page", b"<!DOCTYPE html><html></html>", "this is a web page"),
    ("a.obj", "an archive", b"PK\x03\x04\0\0", "this is a compressed file; unpack it first"),
    (
        "a.obj",
        "an archive that is not compressed",
        b"a.obj".ljust(257, b"\0") + b"ustar\0",
        "this is an archive; unpack",
    ),
    ("a.stl", "compressed as some kernels are", b"\x28\xb5\x2f\xfd\0\0\0" * 20, "this is a compressed file"),
    ("a.obj", "another pointer", b"/annex/objects/MD5-s1--0\n", "a pointer of git-annex, not the mesh"),
    ("a.stl", "a saved page", b"<!-- saved -->\n<html></html>\n", "this is a web page"),
    ("a.obj", "binary STL under another name", BINARY_STL, "this is a file of another format: name it .stl"),
    (
        "a.stl",
        "OBJ under another name",
        b"# made by\n#\n\n" + obj(CUBE),
        "this is a file of another format: name it .obj",
    ),
    ("a.obj", "PLY under another name", ply(CUBE), "this is a file of another format: name it .ply"),
    ("a.ply", "STL under another name", STL, "this is a file of another format: name it .stl"),
    ("a.ply", "triangle strips", ply(CUBE).replace(b"element face", b"element tristrips"), "triangle strips, which"),
    ("a.ply", "cut in a face", ply(CUBE, "<")[:-30], "the file ends in face 5 of 6"),
    ("a.ply", "cut in a vertex", ply(CUBE, ">")[: -6 * 17 - 20], "the file ends in vertex 7 of 8"),
    ("a.ply", "text cut in a face", ply(MIXED)[:-3], "line 27: the file ends in face 9 of 9"),
    ("a.ply", "cut in the header", ply(CUBE)[:100], "the file ends in its header"),
    ("a.ply", "an unknown type", ply(CUBE).replace(b"float y", b"real y"), 'line 6: "real" is no type of PLY'),
    ("a.ply", "an unknown format", ply(CUBE).replace(b"ascii", b"utf8"), 'line 2: "utf8 1.0" is no format of PLY'),
    ("a.ply", "a list counted by fractions", ply(CUBE).replace(b"uchar", b"float"), "line 9: the length of a list"),
    ("a.ply", "no corners", ply(CUBE).replace(b"vertex_ind", b"ind"), "its faces have no list of corners"),
    ("a.ply", "no z", ply(CUBE).replace(b"float z", b"float w"), "its vertices have no property z"),
    ("a.ply", "points", ply(CUBE).replace(b"face 6", b"face 0"), "it has no faces, only vertices"),
    ("a.ply", "a list of fractions", ply(CUBE).replace(b"\n4 ", b"\n4.5 ", 1), "line 19: a list cannot have 4.5"),
    ("a.ply", "a fraction", ply(CUBE).replace(b"\n4 3", b"\n4 3.5", 1), "line 20: face 2 names vertex 3.5, which is"),
    ("a.ply", "a word", ply(CUBE).replace(b"0.0 1.0 1.0", b"0.0 one 1.0"), 'line 18: "one" is not a number'),
    ("a.ply", "UTF-16", ply(CUBE).decode().encode("utf-16"), "this is UTF-16 text"),
    ("a.ply", "a vast header", ply(CUBE).replace(b"face 6", b"face 6000000000"), "its header announces 6000000000"),
    ("a.stl", "cut", BINARY_STL[:-260], "the file ends in face 7 of 12"),
    ("a.stl", "cut in the header", BINARY_STL[:82], "the file ends before its first face"),
    ("a.stl", "text cut", STL[:-80], "line 83: the file ends in face 12"),
    ("a.stl", "no faces", b"solid a\nendsolid a\n", "it has no faces"),
    ("a.stl", "binary without faces", bytes(84), "its header announces 0 faces"),
    ("a.stl", "two coordinates", STL.replace(b" 1.000000e+00\n", b"\n"), "line 4: a vertex has 3 coordinates"),
    ("a.stl", "a word", STL.replace(b"outer", b"inner"), 'line 3: "inner" inside of face 1'),
    ("a.stl", "UTF-16", STL.decode().encode("utf-16"), "this is UTF-16 text"),
    ("a.stl", "words", b"once upon a time\n" * 9, "no STL file: no line of it begins a solid or a facet"),
    ("a.off", "cut in a face", off(CUBE)[:-12], "line 15: the file ends in face 5 of 6"),
    ("a.off", "cut behind a face", off(CUBE)[:-10], "line 15: the file ends in face 6 of 6"),
    ("a.off", "cut behind a vertex", b"OFF\n2 1 0\n0 0 0\n", "line 3: the file ends in vertex 2 of 2"),
    ("a.off", "fewer corners than said", off(CUBE).replace(b"4 3", b"6 3"), "line 12: a face of 6 corners is"),
    ("a.off", "four dimensions", off(CUBE, "4OFF\n{} {} 0\n"), "other than three coordinates are not read"),
    ("a.off", "binary", b"OFF BINARY\n\0\0\0\x08", "this is binary OFF, which is not read"),
    ("a.off", "no counts", off(CUBE, "OFF\n{}\n"), "line 2: the numbers of vertices and of faces are missing"),
    ("a.off", "faces without corners", b"OFF 1 2 0\n0 0 0\n0\n0\n", "all faces of the mesh are degenerate"),
    ("a.off", "words", b"once upon a time\n", 'no OFF file: line 1 begins with "once"'),
    ("a.off", "index beyond the vertices", off(CUBE).replace(b"4 3 2 1 0", b"4 3 2 1 8"), "line 12: 1 of the mesh"),
    ("a.glb", "a fan", glb(*glb_document(TRIANGLES, 6)), "it has triangle fans, which are not read"),
    ("a.glb", "cut", glb(*GLB)[:-8], "the file ends after"),
    ("a.glb", "an old version", glb(*GLB, 1), "its version of glTF is 1; only 2 is read"),
    ("a.glb", "sparse", changed(GLB, "accessors.0.sparse", {"count": 1}), "accessor 0 is sparse"),
    ("a.glb", "normalised", changed(GLB, "accessors.0.normalized", True), "accessor 0 is normalized"),
    ("a.glb", "elsewhere", changed(GLB, "buffers.0.uri", "a.bin"), "data stand outside of its binary"),
    ("a.glb", "too few data", changed(GLB, "accessors.0.count", 99), "the file ends in the data of"),
    ("a.glb", "compressed", changed(GLB, "extensionsUsed", ["KHR_draco_mesh_compression"]), "compressed"),
    ("a.glb", "a node in two places", changed(GLB, "nodes.0.children", [0]), "node 0 stands in two places"),
    ("a.glb", "contradictory", changed(GLB, "nodes.0.mesh", 7), "contradicts itself"),
]

#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Largest mesh that is read; a surface of a head has 0.01 to 1 million triangles.
constexpr int max_mesh_vertices = 10'000'000;
constexpr int max_mesh_triangles = 5'000'000;

/// Reads STL (binary, ASCII), PLY (ASCII, binary of either byte order), OBJ and GLB by the file's
/// extension. Coordinates stay in the file's own unit and axes. STL, which repeats corners, is
/// welded; polygons are triangulated; GLB nodes are transformed and merged. Vertex colours are kept
/// where the format has them. The result has at least one
/// triangle, finite coordinates and valid indices.
/// throws: InputError naming the file, the item and its value, and what to do. Memory stays within
/// a small multiple of the file's size, whatever its header promises.
TriMesh read_mesh(const std::filesystem::path& file);

/// Binary little-endian PLY with double coordinates, so that reading restores the same bits.
/// throws: MachineError; the old file stays intact.
void write_ply(const TriMesh& mesh, const std::filesystem::path& file);

/// The same with a number for each vertex: a property of this name (a word), in single precision.
void write_ply(const TriMesh& mesh, const std::string& property, std::span<const float> values,
               const std::filesystem::path& file);

/// Binary STL (single precision, no colours), for other programs. throws: MachineError.
void write_stl(const TriMesh& mesh, const std::filesystem::path& file);

}  // namespace condyle

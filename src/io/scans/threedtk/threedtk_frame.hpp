#pragma once

#include <array>
#include <span>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"
#include "io/paths/pose_input.hpp"
#include "io/scans/text/text_table.hpp"

/// Conversion between 3DTK's frame and Clearway's. 3DTK is left-handed, in centimetres: x right,
/// y up, z forward. Its readers convert right-handed metres with x forward, y left and z up by
///   x3 = -100 y, y3 = 100 z, z3 = 100 x
/// (3DTK, src/scanio/helper.cc, ScanDataTransform_xyz; globals.icc, toRieglMat). Scans and poses of
/// 3DTK's own formats are converted by the inverse, see docs/design/inputs.md.
namespace clearway {

/// A 4 x 4 matrix, column-major as 3DTK stores and prints it: p' = M p, centimetres, left-handed.
using ThreedtkMatrix = std::array<double, 16>;

/// The point in right-handed metres.
Vec3 from_threedtk(const Vec3& point);
/// The motion of a ThreedtkMatrix as a right-handed row-major 3 x 4 matrix in metres.
std::array<double, 12> from_threedtk(const ThreedtkMatrix& matrix);

/// Makes the matrix of a pose. position: centimetres. angles: degrees about x, y and z, in the
/// order of 3DTK's EulerToMatrix4.
ThreedtkMatrix threedtk_matrix(std::span<const double, 3> position,
                               std::span<const double, 3> angles);

/// Makes a pose of the numbers of a .pose file: x y z and three angles. A seventh number, the time
/// that 3DTK's tools write, is not used. pose: right-handed, metres.
Objection pose_of_threedtk_euler(std::span<const double> numbers, Pose& pose);

/// Makes a pose of the numbers in a line of a .frames file: a ThreedtkMatrix, perhaps followed by
/// the colour in which 3DTK shows the scan. pose: right-handed, metres, rigid unless
/// `allow_non_rigid`.
Objection pose_of_threedtk_frame(std::span<const double> numbers, bool allow_non_rigid, Pose& pose);

/// Reads a .pose file, whose numbers may be on any lines. Throws InputError.
Pose read_threedtk_pose(TextTable& table);
/// Reads a .frames file to its end. The last line is used, which is where registration left the
/// scan. Throws InputError, also for a malformed line before the last one.
Pose read_threedtk_frames(TextTable& table);

}  // namespace clearway

#pragma once

#include <cstdint>
#include <filesystem>

#include "clearway/vec3.hpp"

/// Variants of a scene's files, for experiments: files in, files out, the same bytes for the same
/// arguments. An existing output is replaced. All throw UsageError for arguments that make no
/// sense, InputError for malformed inputs and ResourceError as the readers and writers do.
///
/// Environments are LAS as `clearway scene` writes it, read and written in constant memory; points
/// keep their order. There is none of another scale: `clearway convert --scale S` rounds LAS to S.
namespace clearway::bench {

/// Writes an environment at another place: every byte of the points is kept, and the header's
/// offsets and bounds are moved. shift: whole metres, such that offset + shift is exact (else
/// UsageError).
void shift_environment(const std::filesystem::path& las_in, const std::filesystem::path& las_out,
                       const Vec3& shift);

/// Writes a random sample, without replacement, of exactly points_wanted points, at most as many as
/// there are; every set of that size is equally likely. Records are kept byte for byte, and so is
/// the header but for its counts: the bounds stay those of all points, and each point counts as a
/// first return. Source: Knuth, The Art of Computer Programming 2, section 3.4.2, algorithm S.
void sample_environment(const std::filesystem::path& las_in, const std::filesystem::path& las_out,
                        std::uint64_t points_wanted, std::uint64_t seed);

inline constexpr std::uint64_t kStrayPoints = 8;
inline constexpr double kGreatestStretch = 1000;

/// Writes all points and, after them, kStrayPoints at the corners of their bounding box, which is
/// made `factor` (1 to kGreatestStretch) times as long on each axis about its centre. The scale of
/// the stored integers is multiplied by the least power of ten with which the box of
/// kGreatestStretch fits 32 bits, so it is the same for every factor. Returns that power: with 1
/// the points keep their integers, offset and scale; otherwise each is rounded to nearest. Other
/// fields of the records are not kept.
int stretch_environment(const std::filesystem::path& las_in, const std::filesystem::path& las_out,
                        double factor);

/// Writes one point of every occupied voxel of a regular grid of side `voxel` (metres) through the
/// model's origin: the original point nearest to the voxel's centre, the first of several. The
/// output is PLY in double, in the model's order. The reference implementation of the paper (3DTK)
/// thins by an octree about the cloud's own box, whose leaves' size follows from that box, and
/// takes a leaf's centre or random points of it; here the size is the one asked for and the points
/// are the model's own.
void write_thinned_model(const std::filesystem::path& in, const std::filesystem::path& out,
                         double voxel);

/// Writes a closed body like a car's that fills the box of a model, |x/a|^4 + |y/b|^4 + |z/c|^4 =
/// 1, as OFF. triangles: 2 n^2 for a whole n of 3 or more; other numbers are rounded down to such a
/// number.
void write_body(const std::filesystem::path& in, const std::filesystem::path& out,
                std::uint64_t triangles);

/// Trajectories are written as io/paths/trajectory_file.hpp does, which gives back every
/// double. The variants accept poses that are not rigid.

/// Writes poses 0, n, 2 n, ... and the last one. n > 0.
void write_every_nth_pose(const std::filesystem::path& in, const std::filesystem::path& out,
                          std::uint64_t n);

/// Writes the first of `parts` equal parts of the path, rounded up. parts > 0.
void write_first_poses(const std::filesystem::path& in, const std::filesystem::path& out,
                       std::uint64_t parts);

/// Writes the poses with `shift` added to their translations, rounded to double.
void write_shifted_poses(const std::filesystem::path& in, const std::filesystem::path& out,
                         const Vec3& shift);

/// Writes every pose moved rigidly and independently: translated by normal noise of sigma_m metres
/// an axis, and turned about its own origin by a rotation vector of sigma_rad radians an axis. The
/// noise is a sum of four uniforms, within 3.5 sigma.
void write_noisy_poses(const std::filesystem::path& in, const std::filesystem::path& out,
                       double sigma_m, double sigma_rad, std::uint64_t seed);

/// Writes the middle pose turned about the model's z axis in `count` equal steps from 0 to 360
/// degrees. count > 1.
void write_turning_poses(const std::filesystem::path& in, const std::filesystem::path& out,
                         std::uint64_t count);

/// Writes the trajectory `passes` times, every second time backwards. Normal noise of sigma_m
/// metres an axis moves each pass as a whole.
void write_to_and_fro(const std::filesystem::path& in, const std::filesystem::path& out, int passes,
                      double sigma_m, std::uint64_t seed);

/// Writes every pose moved along its own y axis.
void write_poses_aside(const std::filesystem::path& in, const std::filesystem::path& out,
                       double metres);

/// Writes poses that stretch the model along its x axis by 1 + stretch: the rotation's first column
/// is multiplied by that. stretch > -1.
void write_non_rigid_poses(const std::filesystem::path& in, const std::filesystem::path& out,
                           double stretch);

}  // namespace clearway::bench

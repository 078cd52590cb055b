#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// What the caller can do about an error. A program words it in terms of its own options.
enum class Remedy {
  kNone,
  kMoreMemory,        ///< amount: bytes that are enough, 0 if not known
  kMoreDeviceMemory,  ///< amount: bytes that are enough on each GPU
  kOtherGpu,          ///< another GPU, or the CPU
  kCpuDevice,         ///< the CPU, because a GPU failed or there is none
  kNewProcess,        ///< a new process, or the CPU, because this one cannot use the GPU any more
  kLessDeviceMemory,  ///< a smaller budget of GPU memory, or the CPU
  kLessMemory,        ///< a smaller memory budget, or the CPU
  kFewerThreads,
  kSweepEngine,  ///< use engine sweep, which can do what was asked; the engine chosen cannot
  kCudaDevice,
  kMoreCellPoints,
  kFewerCellPoints,
  kScale,        ///< amount: a step in metres that fits, 0: any coarser one
  kOneScale,     ///< one scale for all inputs; amount: a step in metres, 0: the caller's choice
  kAcceptScale,  ///< amount: the step in metres that the range needs, if that is accepted
  kColumns,      ///< name the columns of a text; amount: a likely one of x, from 1, 0 if not known
  /// Give a path from which the file can be read to its end, instead of standard input
  kStandardInput,
  kSampleMesh,         ///< the file is a mesh where points are expected; its surface can be sampled
  kSkipUnreadable,     ///< one of several inputs is bad; the others can be converted without it
  kIgnoreCrs,          ///< amount: metres of the unit of heights, where naming it helps too; or 0
  kOverwrite,          ///< the output exists
  kReadOrOverwrite,    ///< the output exists, and is already the answer that was asked for
  kResumeOrOverwrite,  ///< an unfinished run of this output exists
  kOverwriteNotResume,  ///< the run that was to be resumed is damaged
  kRestoreOptions,      ///< the run that was to be resumed belongs to other options or files
  kNameFormat,          ///< name the trajectory's format
  kNameCrs,        ///< name the coordinate reference system that the trajectory is converted to
  kDeclareAngles,  ///< declare unit and frame of the trajectory's angles
  kDeclareLength,  ///< declare the unit of the trajectory's positions
  kAllowNonRigid,
  kGiveHeight,    ///< give the height of a line that has none
  kRoundCorners,  ///< round the corners of a line with arcs of a radius
  kAskForClearance,
  kAskForFirstPose,
  kSameTrajectory,   ///< give the trajectory's file and options that the search had
  kSameModel,        ///< give the model's file and options that the search had
  kSameEnvironment,  ///< give the store that was searched
  kAskForProfile,
  kModelSpacing,  ///< name a spacing for the mesh; amount: metres that fit, 0: the caller's choice
  kResume,        ///< repeat the same call, which continues from what was finished
  kMerge,         ///< merge the parts first: the file is one part of a result
  /// Search or ask with points of the surface, where the surface itself is not possible
  kModelPoints,
  kFreeDisk,       ///< free some room on the disk, or write to another one
  kWiderCorridor,  ///< the scans have to be converted with a larger `within`; amount: metres
  kOtherPart,      ///< the output belongs to another part, or to the whole, than the one asked for
  kMakeLedger,     ///< there is no such ledger yet; an update makes it
};

/// Base of all errors that the outside world causes. A program chooses its exit code by the type.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what, Remedy remedy = Remedy::kNone, double amount = 0)
      : std::runtime_error(what), remedy_(remedy), amount_(amount) {}

  Remedy remedy() const { return remedy_; }
  double amount() const { return amount_; }  ///< number that belongs to the remedy: see Remedy

 private:
  Remedy remedy_;
  double amount_;
};

/// Options that contradict each other or ask for what cannot be done. Exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A malformed or unsupported input: what() names file, line or byte, and what was expected.
/// Exit code 3.
class InputError : public Error {
 public:
  using Error::Error;
};

/// An I/O failure, or a lack of some resource, such as a full disk or too small a memory budget.
/// Exit code 4.
class ResourceError : public Error {
 public:
  using Error::Error;
};

/// Stopped on request; whatever a journal holds is kept. Exit code 5.
class Interrupted : public Error {
 public:
  using Error::Error;
};

}  // namespace clearway

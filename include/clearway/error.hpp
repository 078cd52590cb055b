#pragma once

#include <stdexcept>
#include <string>

namespace clearway {

/// What the caller can do about an error. A program words it in terms of its own options.
enum class Remedy {
  kNone,
  kMoreMemory,        ///< amount: bytes that are enough, 0: not known
  kMoreDeviceMemory,  ///< amount: bytes of each GPU that are enough
  kOtherGpu,          ///< or the CPU
  kCpuDevice,         ///< a GPU failed, or there is none
  kLessDeviceMemory,  ///< or the CPU
  kLessMemory,        ///< or the CPU
  kFewerThreads,
  kSweepEngine,  ///< the engine cannot do what was asked; engine sweep can
  kGridEngine,
  kCudaDevice,
  kMoreCellPoints,
  kFewerCellPoints,
  kScale,           ///< amount: a step in metres that fits, 0: a coarser one
  kOneScale,        ///< for all inputs; amount: a step in metres, 0: the caller's choice
  kAcceptScale,     ///< amount: the step in metres that the range needs, if that is accepted
  kColumns,         ///< of a text, which the caller can name
  kStandardInput,   ///< where the file can be read from, to its end
  kSampleMesh,      ///< the file is a mesh where points are expected; its surface gives some
  kSkipUnreadable,  ///< one of several inputs; the others can be converted without it
  kIgnoreCrs,
  kOverwrite,           ///< the output exists
  kReadOrOverwrite,     ///< the output exists, and is the answer that was asked for
  kResumeOrOverwrite,   ///< an unfinished run of this output exists
  kOverwriteNotResume,  ///< what was to be resumed is damaged
  kRestoreOptions,      ///< what was to be resumed belongs to other options or files
  kNameFormat,          ///< of the trajectory
  kNameCrs,             ///< that the trajectory is to be in
  kDeclareAngles,       ///< unit and frame of the trajectory's angles
  kDeclareLength,       ///< unit of the trajectory's positions
  kAllowNonRigid,
  kAskForClearance,
  kAskForFirstPose,
  kSameTrajectory,   ///< the file and options that the search had
  kSameModel,        ///< likewise
  kSameEnvironment,  ///< the store that was searched
  kAskForProfile,
  kModelSpacing,  ///< of a mesh; amount: metres that fit, 0: the caller's choice
  kResume,        ///< the same call goes on from what was finished
  kMerge,         ///< the file is one part of a result
  kModelPoints,   ///< points of the surface can be asked about, where the surface cannot
  kOtherPart,     ///< the output is not of the part, or the whole, that is asked for
};

/// What the world does wrong. A program chooses its exit code by the type.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what, Remedy remedy = Remedy::kNone, double amount = 0)
      : std::runtime_error(what), remedy_(remedy), amount_(amount) {}

  Remedy remedy() const { return remedy_; }
  double amount() const { return amount_; }  ///< as the remedy says

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

/// I/O failure or a resource that is not there (disk full, budget too small). Exit code 4.
class ResourceError : public Error {
 public:
  using Error::Error;
};

/// Stopped on request, with nothing lost that a journal holds. Exit code 5.
class Interrupted : public Error {
 public:
  using Error::Error;
};

}  // namespace clearway

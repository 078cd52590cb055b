#include "cli/support/advice.hpp"

#include <algorithm>

#include "core/util/format.hpp"

namespace clearway::tool {
namespace {

/// An option with a size in a form that it takes, without rounding.
std::string size_option(const std::string& name, double bytes) {
  return name + " " + std::to_string(static_cast<std::uint64_t>(bytes));
}

}  // namespace

std::string advice_on(const Error& error) {
  switch (error.remedy()) {
    case Remedy::kNone:
      return "";
    case Remedy::kMoreMemory:
      return "; " + size_option("--memory", error.amount()) + " is enough";
    case Remedy::kMoreDeviceMemory:
      return "; " + size_option("--device-memory", error.amount()) + " is enough";
    case Remedy::kOtherGpu:
      return "; nvidia-smi lists what else uses it: take other GPUs with --gpus, or --device cpu";
    case Remedy::kCpuDevice:
      return "; --device cpu does without a GPU; nvidia-smi lists the GPUs that can be used; an "
             "unfinished run continues with --resume";
    case Remedy::kLessDeviceMemory:
      return "; nvidia-smi lists what else uses the GPU: take less --device-memory, or --device "
             "cpu";
    case Remedy::kLessMemory:
      return "; take less --memory, or --device cpu";
    case Remedy::kFewerThreads:
      return "; give fewer --threads, or raise the limit";
    case Remedy::kSweepEngine:
      return "; take --engine sweep";
    case Remedy::kGridEngine:
      return "; take --engine grid";
    case Remedy::kCudaDevice:
      return "; take --device cuda";
    case Remedy::kMoreCellPoints:
      return "; with more --cell-points there are fewer cells";
    case Remedy::kFewerCellPoints:
      return "; fewer --cell-points avoid that";
    case Remedy::kScale:
      return error.amount() > 0 ? "; --scale " + format_number(error.amount()) + " fits"
                                : "; a coarser --scale is needed";
    case Remedy::kOneScale:
      return "; --scale " + (error.amount() > 0 ? format_number(error.amount()) : "METRES") +
             " sets one for all";
    case Remedy::kAcceptScale:
      return "; --scale " + format_number(error.amount()) + " accepts that step";
    case Remedy::kColumns:
      return "; --columns says which ones hold x, y and z, for example --columns 2,3,4";
    case Remedy::kStandardInput:
      return "; clearway convert - < FILE takes it as standard input";
    case Remedy::kSampleMesh:
      return "; clearway model samples its surface to points in PLY";
    case Remedy::kSkipUnreadable:
      return "; --skip-unreadable leaves out the files that cannot be read";
    case Remedy::kIgnoreCrs:
      return "; --ignore-crs takes the coordinates as they are";
    case Remedy::kOverwrite:
      return "; --force overwrites it, or give another name for the output";
    case Remedy::kReadOrOverwrite:
      return "; --resume repeats that answer without a search, and --force searches again";
    case Remedy::kResumeOrOverwrite:
      return "; --resume continues it, --force starts again";
    case Remedy::kOverwriteNotResume:
      return "; --force instead of --resume overwrites it, or give another name for the output";
    case Remedy::kRestoreOptions:
      return "; give the options and files that it was started with, or --force to start again";
    case Remedy::kNameFormat:
      return "; --trajectory-format names it";
    case Remedy::kNameCrs:
      return "; --trajectory-crs names it, for example --trajectory-crs EPSG:25832";
    case Remedy::kDeclareAngles:
      return "; --angles says it: deg or rad, ned or enu, for example --angles deg,ned";
    case Remedy::kDeclareLength:
      return "; --trajectory-unit says it";
    case Remedy::kAllowNonRigid:
      return "; --allow-non-rigid accepts any invertible matrix";
    case Remedy::kAskForClearance:
      return "; run with --clearance";
    case Remedy::kAskForFirstPose:
      return "; run with --first-pose";
    case Remedy::kSameTrajectory:
      return ". --trajectory takes the file of the run, with the same options";
    case Remedy::kSameModel:
      return ". --model or --vehicle takes the file of the run, with the same --model-... options";
    case Remedy::kSameEnvironment:
      return ". --env takes the store of the run, or another one of the same scans";
    case Remedy::kAskForProfile:
      return "; run with --profile";
    case Remedy::kModelSpacing:
      return "; --model-spacing " +
             (error.amount() > 0 ? format_number(error.amount()) : "METRES") +
             " sets it, and --model-unit says what the file counts in";
    case Remedy::kResume:
      return "; the same command with --resume, without --force, continues from the finished work";
    case Remedy::kModelPoints:
      return "; --model-as points searches points of it, and the answer says how far its surface "
             "may be from them";
    case Remedy::kMerge:
      return "; clearway merge makes the result of all parts";
    case Remedy::kOtherPart:
      return "; give the same --shard as its run, or another output. --force instead of --resume "
             "overwrites it";
  }
  return "";
}

std::string advice_on(const Message& message) {
  if (message.code == "large-steps") {
    const bool searched_between = std::ranges::any_of(
        message.numbers, [](const auto& n) { return n.first == "turn_degrees"; });
    if (searched_between) {
      return message.severity == Message::Severity::kNote
                 ? ""
                 : ". More poses of the recording help; where none are missing, clearway "
                   "trajectory "
                   "resample adds poses on a smooth curve";
    }
    return ". --between-poses searches the way too; clearway trajectory resample adds poses";
  }
  if (message.code == "loose-vertices") {
    return ", or search all vertices, and nothing else of the file, with --model-vertices";
  }
  if (message.code == "one-long-conflict") {
    return ". clearway run --model-above leaves out the lowest part of the model";
  }
  return "";
}

}  // namespace clearway::tool

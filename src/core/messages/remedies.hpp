#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "clearway/error.hpp"

namespace clearway {

/// What the number of a remedy is.
enum class RemedyAmount { kNothing, kBytes, kNumber, kColumn, kLengthUnit };

/// How a remedy is worded.
struct RemedyKind {
  Remedy remedy;
  std::string_view name;   ///< in Python
  std::string_view words;  ///< what the command line appends to the error
  RemedyAmount amount = RemedyAmount::kNothing;
  /// The words of the command line where the amount is above 0; {} stands for it. Empty where the
  /// amount changes nothing.
  std::string_view words_with_amount = "";
};

namespace remedy_table {

using enum Remedy;
using enum RemedyAmount;

/// The remedies in the order of the enumeration. The table of docs/guide/command-line.md is made
/// from this one.
inline constexpr auto kRemedies = std::to_array<RemedyKind>({
    {kNone, "", ""},
    {kMoreMemory, "more_memory", "; give more with --memory", kBytes, "; --memory {} is enough"},
    {kMoreDeviceMemory, "more_device_memory", "; give more with --device-memory", kBytes,
     "; --device-memory {} is enough"},
    {kOtherGpu, "other_gpu",
     "; nvidia-smi lists what else uses it: take other GPUs with --gpus, or --device cpu"},
    {kCpuDevice, "cpu_device",
     "; --device cpu does without a GPU; nvidia-smi lists the GPUs that can be used; an unfinished "
     "run continues with --resume"},
    {kNewProcess, "new_process",
     "; start the command again, where --resume continues an unfinished run, or take --device cpu"},
    {kLessDeviceMemory, "less_device_memory",
     "; nvidia-smi lists what else uses the GPU: take less --device-memory, or --device cpu"},
    {kLessMemory, "less_memory", "; take less --memory, or --device cpu"},
    {kFewerThreads, "fewer_threads", "; give fewer --threads, or raise the limit"},
    {kSweepEngine, "sweep_engine", "; take --engine sweep"},
    {kCudaDevice, "cuda_device", "; take --device cuda"},
    {kMoreCellPoints, "more_cell_points", "; with more --cell-points there are fewer cells"},
    {kFewerCellPoints, "fewer_cell_points", "; fewer --cell-points avoid that"},
    {kScale, "scale", "; a coarser --scale is needed", kNumber, "; --scale {} fits"},
    {kOneScale, "one_scale", "; --scale METRES sets one for all", kNumber,
     "; --scale {} sets one for all"},
    {kAcceptScale, "accept_scale", "; --scale METRES accepts a step", kNumber,
     "; --scale {} accepts that step"},
    {kColumns, "columns",
     "; --columns says which ones hold x, y and z, for example --columns 2,3,4", kColumn,
     "; --columns says which ones hold x, y and z, for example --columns {}"},
    {kStandardInput, "standard_input", "; clearway convert - < FILE takes it as standard input"},
    {kSampleMesh, "sample_mesh",
     "; clearway model FILE --spacing METRES -o FILE.ply samples its surface to points, which "
     "convert takes, and --skip-unreadable leaves it out beside scans"},
    {kSkipUnreadable, "skip_unreadable",
     "; --skip-unreadable leaves out the files that cannot be read"},
    {kIgnoreCrs, "ignore_crs", "; --ignore-crs takes the coordinates as they are", kLengthUnit,
     "; --unit-z {} converts the heights, and --ignore-crs takes the coordinates as they are"},
    {kOverwrite, "overwrite", "; --force overwrites it, or give another name for the output"},
    {kReadOrOverwrite, "read_or_overwrite",
     "; --resume repeats that answer without a search, and --force searches again"},
    {kResumeOrOverwrite, "resume_or_overwrite", "; --resume continues it, --force starts again"},
    {kOverwriteNotResume, "overwrite_not_resume",
     "; --force instead of --resume overwrites it, or give another name for the output"},
    {kRestoreOptions, "restore_options",
     "; give the options and files that it was started with, or --force to start again"},
    {kNameFormat, "name_format", "; --trajectory-format names it"},
    {kNameCrs, "name_crs", "; --trajectory-crs names it, for example --trajectory-crs EPSG:25832"},
    {kDeclareAngles, "declare_angles",
     "; --angles says it: deg or rad, ned or enu, for example --angles deg,ned"},
    {kDeclareLength, "declare_length", "; --trajectory-unit says it"},
    {kAllowNonRigid, "allow_non_rigid", "; --allow-non-rigid accepts any invertible matrix"},
    {kGiveHeight, "give_height",
     "; --height gives one for all of it, and --on-ground takes that of the ground in a scan"},
    {kRoundCorners, "round_corners",
     "; --corner-radius METRES puts arcs at the vertices, and more vertices describe a curve"},
    {kAskForClearance, "ask_for_clearance", "; run with --clearance"},
    {kAskForFirstPose, "ask_for_first_pose", "; run with --first-pose"},
    {kSameTrajectory, "same_trajectory",
     ". --trajectory takes the file of the run, with the same options"},
    {kSameModel, "same_model",
     ". --model or --vehicle takes the file of the run, with the same options of the model"},
    {kSameEnvironment, "same_environment",
     ". --env takes the store of the run, or another one of the same scans"},
    {kAskForProfile, "ask_for_profile", "; run with --profile"},
    {kModelSpacing, "model_spacing",
     "; --model-spacing METRES sets it, and --model-unit says what the file counts in", kNumber,
     "; --model-spacing {} sets it, and --model-unit says what the file counts in"},
    {kResume, "resume",
     "; the same command with --resume, without --force, continues from the finished work"},
    {kMerge, "merge", "; clearway merge makes the result of all parts"},
    {kModelPoints, "model_points",
     "; --model-as points searches points of it, and the answer says how far its surface may be "
     "from them"},
    {kFreeDisk, "free_disk", "; free some room, or write to a disk with more"},
    {kWiderCorridor, "wider_corridor", "; convert the scans with a larger --within", kNumber,
     "; convert the scans with --within {} or more, or without --near"},
    {kOtherPart, "other_part",
     "; give the same --shard as its run, or another output. --force instead of --resume "
     "overwrites it"},
    {kMakeLedger, "make_ledger", "; clearway conflicts --update makes it"},
});

}  // namespace remedy_table

/// How a remedy is worded. Throws std::out_of_range for one that the table lacks.
constexpr const RemedyKind& kind_of(Remedy remedy) {
  return remedy_table::kRemedies.at(static_cast<std::size_t>(remedy));
}

static_assert(
    [] {
      for (std::size_t i = 0; i < remedy_table::kRemedies.size(); ++i) {
        if (remedy_table::kRemedies[i].remedy != static_cast<Remedy>(i)) return false;
      }
      return kind_of(Remedy::kMakeLedger).remedy == Remedy::kMakeLedger;
    }(),
    "the rows of the remedies are in the order of the enumeration");

}  // namespace clearway

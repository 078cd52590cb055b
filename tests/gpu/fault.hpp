#pragma once

namespace clearway {

/// Starts a kernel on the first CUDA device that writes where no memory is. The process cannot use
/// the device afterwards.
void fault_on_device();

}  // namespace clearway

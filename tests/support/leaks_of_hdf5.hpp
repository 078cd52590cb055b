#pragma once

#include <hdf5.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace clearway::test {

/// Turns the leak check off while it lives, because HDF5 1.10.8 loses buffers where it fails on
/// damaged metadata or cannot close a file. Buffers of earlier calls that HDF5 keeps to use again
/// are freed first, since it may lose these too.
class LeaksOfHdf5 {
 public:
  LeaksOfHdf5() {
    H5dont_atexit();  // before HDF5's first call, as in src/io, because it fails on a file it
                      // cannot close
    H5garbage_collect();
  }

 private:
#ifdef __SANITIZE_ADDRESS__
  __lsan::ScopedDisabler disabler_;
#endif
};

}  // namespace clearway::test

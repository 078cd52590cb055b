#pragma once

#include <hdf5.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace clearway::test {

/// HDF5 1.10.8 loses buffers where it fails on damaged metadata or cannot close a file: while one
/// of these lives, the leak check looks away. Buffers of earlier calls that HDF5 keeps to use again
/// are given back first: it may lose these too.
class LeaksOfHdf5 {
 public:
  LeaksOfHdf5() {
    H5dont_atexit();  // before its first call, as src/io does: it fails on a file it cannot close
    H5garbage_collect();
  }

 private:
#ifdef __SANITIZE_ADDRESS__
  __lsan::ScopedDisabler disabler_;
#endif
};

}  // namespace clearway::test

#pragma once

/// CLEARWAY_HD marks a function compiled for the host and, under nvcc, for the device.
#ifdef __CUDACC__
#define CLEARWAY_HD __host__ __device__
#else
#define CLEARWAY_HD
#endif

#pragma once

#include "core/stopwatch.hpp"

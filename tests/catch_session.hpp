#pragma once

/// Runs the tests that the arguments name. Where they are to be run and not only listed, and
/// `missing` returns a text, it prints that and returns 77, which means skipped. `missing` may be
/// null.
int run_catch(int argc, char** argv, const char* (*missing)() = nullptr);

// SPDX-License-Identifier: Apache-2.0
// What compiles a set of precompiled headers needs a file to compile
// (cmake/StrataPrecompile.cmake).

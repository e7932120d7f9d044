// SPDX-License-Identifier: Apache-2.0
/// A shared library that is no component library.
int nothing_of_ours() { return 1; }

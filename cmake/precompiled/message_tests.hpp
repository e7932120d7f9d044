// SPDX-License-Identifier: Apache-2.0
/// What most tests of components and tools read.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cmake/precompiled/messages.hpp"

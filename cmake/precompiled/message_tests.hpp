// SPDX-License-Identifier: Apache-2.0
/// What most tests of components and tools read.
#pragma once

#include "cmake/precompiled/messages.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

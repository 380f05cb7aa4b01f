#pragma once

/// Tests within dlo see the helpers of all tests.
namespace dlo {
namespace test {}
using namespace test;
}  // namespace dlo

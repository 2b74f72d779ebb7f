/** @file
 * codewheel/version.h - version of the codewheel runtime
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * The headers in this folder form the runtime. The runtime is the same for all manufacturers, so a
 * program needs only one copy, which the header of each encoder includes.
 *
 * A header for an encoder works with a runtime of the same major version, and at least the minor
 * version that it was generated with. It does not compile with any other runtime. A newer minor
 * version only adds to the runtime, so if you have several copies, use the newest one.
 */
#ifndef CODEWHEEL_VERSION_H
#define CODEWHEEL_VERSION_H

#define CW_RUNTIME_MAJOR 1 /**< changes when existing code would no longer work */
#define CW_RUNTIME_MINOR 0 /**< changes when something is added */

#endif

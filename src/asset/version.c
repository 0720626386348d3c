// SPDX-License-Identifier: MIT
#include "asset.h"

uint32_t nacre_version(void)
{
    return NACRE_VERSION;
}

const char *nacre_result_text(nacre_result result)
{
    switch (result) {
    case NACRE_OK:
        return "success";
    case NACRE_ERR_ARGUMENT:
        return "an argument is not valid";
    case NACRE_ERR_MEMORY:
        return "the block given is too small";
    case NACRE_ERR_ASSET:
        return "the asset is truncated or damaged";
    case NACRE_ERR_UNSUPPORTED:
        return "not supported here";
    case NACRE_ERR_BUDGET:
        return "beyond the budget";
    case NACRE_ERR_GL:
        return "GL refused; see the log";
    case NACRE_ERR_LOST:
        return "the GL context is lost";
    }
    return "unknown result";
}

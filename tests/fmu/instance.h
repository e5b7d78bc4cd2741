/* A running slip law, as both standards hold one. Who includes this has said before what a `Caller` is (whoever runs the
 * model and hears its messages) and how it is told something: `static void tell(Caller, int status, const char *message)`.
 */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "slip_law.h"

typedef struct {
    Law law;
    Caller caller;
} Instance;

/* A new one; none for a caller with another model's token. */
static Instance *instance_new(const char *token, const char *own, Caller caller) {
    Instance *instance = strcmp(token, own) == 0 ? calloc(1, sizeof *instance) : NULL;
    if (instance != NULL) {
        law_reset(&instance->law);
        instance->caller = caller;
    }
    return instance;
}

static int instance_step(Instance *instance, double t, double step) {
    const int status = law_step(&instance->law, t, step);
    if (status != OK) {
        tell(instance->caller, status, "the inverter tripped");
    }
    return status;
}

static int instance_reset(Instance *instance) {
    law_reset(&instance->law);
    return OK;
}

#endif

/* Slip control of a locomotive with two bogies of three axles, as an FMU holds it; instance.h makes a model of it.
 *
 * One torque for each bogie: a PI law holds the slip of its fastest axle at the reference, between nothing and the torque
 * limit; the integral is kept where the torque just stays in between. The law is that of the vehicle's own controller.
 */
#ifndef SLIP_LAW_H
#define SLIP_LAW_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK = 0, ERROR = 3 };

/* Value references; modelDescription*.xml has the same. */
enum { SLIP = 0, TORQUE = 6, KP = 8, KI, SLIP_REFERENCE, TORQUE_LIMIT, FAIL_AT, NAN_AT, EARLY_PARTS, STUCK_AT, VALUES };

typedef struct {
    double value[VALUES];
    double integral[2];
    int parts; /* of a step that has returned early (FMI 3), those that are done */
    double begun, whole;
} Law;

static void law_reset(Law *law) {
    memset(law, 0, sizeof *law);
    law->value[KP] = 2.0e5;
    law->value[KI] = 4.0e5;
    law->value[SLIP_REFERENCE] = 0.05;
    law->value[TORQUE_LIMIT] = 2.0e4;
    law->value[FAIL_AT] = law->value[NAN_AT] = law->value[STUCK_AT] = 1.0e9;
    law->value[EARLY_PARTS] = 1.0;
}

/* One sample at time t (s) that holds for the period (s). */
static int law_step(Law *law, double t, double period) {
    const double *v = law->value;
    if (t >= v[FAIL_AT]) {
        return ERROR;
    }
    for (int bogie = 0; bogie < 2; bogie++) {
        const double *slip = &v[SLIP + 3 * bogie];
        const double fastest = fmax(fmax(slip[0], slip[1]), slip[2]);
        const double error = v[SLIP_REFERENCE] - fastest;
        const double proportional = v[KP] * error;
        const double least = fmin(-proportional, 0.0), most = fmax(v[TORQUE_LIMIT] - proportional, 0.0);
        double *integral = &law->integral[bogie];
        *integral = fmin(fmax(*integral + v[KI] * error * period, least), most);
        law->value[TORQUE + bogie] = fmin(fmax(proportional + *integral, 0.0), v[TORQUE_LIMIT]);
    }
    if (t >= v[NAN_AT]) {
        law->value[TORQUE] = NAN;
    }
    return OK;
}

static int law_write(Law *law, const unsigned *references, size_t count, const double *values) {
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= VALUES) {
            return ERROR;
        }
        law->value[references[i]] = values[i];
    }
    return OK;
}

static int law_read(const Law *law, const unsigned *references, size_t count, double *values) {
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= VALUES) {
            return ERROR;
        }
        values[i] = law->value[references[i]];
    }
    return OK;
}

/* A function of the standard that this model does not offer. */
#define ABSENT(name) \
    EXPORT int name(void) { \
        return ERROR; \
    }

/* One in which there is nothing to do. */
#define NOTHING(name) \
    EXPORT int name(void) { \
        return OK; \
    }

#endif

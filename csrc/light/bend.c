/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ellipsoids that bend light: inside one, light falls as on a ball, and nothing in it throws shadows there, so that a
 * face is lit by one clean shape, whatever nose and eyes it has. */
#include "light/handle.h"
#include "light/light.h"

void ISA(bend_make)(light *l)
{
	static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
	l->n_bends = 0;
	for (int k = 0; k < l->job->n_bends; k++) {
		const encre_bend *given = l->job->bends + k;
		bend *b = l->bends + l->n_bends;
		double inverse[16], own[3];
		if (!(given->amount > 0) || !camera_inverse(same, given->model, inverse))
			continue; /* flat ones have no inside */
		memcpy(b->inverse, inverse, sizeof b->inverse);
		transform_point(b->inverse, l->origin, own);
		for (int r = 0; r < 3; r++)
			b->inverse[4 * r + 3] = own[r];
		b->amount = given->amount;
		b->fade = given->fade;
		l->n_bends++;
	}
}

/* Where a place is in the ball that the ellipsoid is made of; how far inside, 0..1 from its surface to its middle. */
static float inside(const bend *b, vec at, vec *own)
{
	double given[3] = {(double)at.x, (double)at.y, (double)at.z}, p[3];
	transform_point(b->inverse, given, p);
	*own = (vec){(float)p[0], (float)p[1], (float)p[2]};
	float square = dot(*own, *own);
	return square < 1 ? 1 - sqrtf(square) : 0;
}

/* How far it bends the light there. */
static float share_of(const bend *b, float deep)
{
	return b->amount * (b->fade > 1e-6f ? clamp01(deep / b->fade) : 1);
}

/* The direction away from the middle, by which an ellipsoid's surface stands: by the transposed inverse. */
static vec outward(const bend *b, vec own)
{
	const double *m = b->inverse;
	double x = (double)own.x, y = (double)own.y, z = (double)own.z;
	return unit((vec){(float)(m[0] * x + m[4] * y + m[8] * z), (float)(m[1] * x + m[5] * y + m[9] * z),
			  (float)(m[2] * x + m[6] * y + m[10] * z)});
}

void ISA(bend_normal)(const light *l, surface *s)
{
	for (int k = 0; k < l->n_bends; k++) {
		const bend *b = l->bends + k;
		vec own;
		float deep = inside(b, s->at, &own);
		if (!(deep > 0))
			continue;
		float share = share_of(b, deep);
		vec n = plus(times(s->normal, 1 - share), times(outward(b, own), share));
		if (dot(n, n) > 1e-6f)
			s->normal = unit(n);
	}
}

float ISA(bend_free)(const light *l, vec at, vec way)
{
	float most = 0;
	for (int k = 0; k < l->n_bends; k++) {
		const bend *b = l->bends + k;
		vec own;
		float deep = inside(b, at, &own);
		if (!(deep > 0))
			continue;
		vec to = transform_way(b->inverse, way);
		float square = dot(to, to), half = dot(own, to), out = dot(own, own) - 1;
		/* a part of the way where the normal is bent in part, or what keeps its own normal would lose its
		 * shadow */
		float whole = (sqrtf(max(half * half - square * out, 0)) - half) / max(square, 1e-30f);
		most = max(most, share_of(b, deep) * whole);
	}
	return most;
}
